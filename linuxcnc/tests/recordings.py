"""Recordings of the component, to the bit: inputs and outputs of each servo period, as of components/recording.h and feedwright.h."""
import dataclasses
import struct

CHANNELS = 6
HEADER = struct.Struct("<8sIIqQ")
INPUTS = struct.Struct(f"<3d3d3d6d{CHANNELS}d{CHANNELS}d2I")
OUTPUTS = struct.Struct(f"<3d3d3d3d{CHANNELS}d{CHANNELS}d5d10I")


@dataclasses.dataclass
class Period:
    """What went through the link. `settings` are delay, deviation, speed, acceleration of fades and of the loop, and scale."""
    command: tuple
    actual: tuple
    settings: tuple
    drive: tuple
    feedback: tuple
    correction: tuple
    geometry: tuple
    through: tuple
    through_actual: tuple
    through_drive: tuple
    through_feedback: tuple
    state: int
    fault: int
    delay: int
    numbers: tuple


def read(path):
    """Every servo period of a recording."""
    content = path.read_bytes()
    _, _, model, _, count = HEADER.unpack_from(content)
    begin, periods = HEADER.size + model, []
    for i in range(count):
        at = begin + i * (INPUTS.size + OUTPUTS.size)
        given, made = INPUTS.unpack_from(content, at), OUTPUTS.unpack_from(content, at + INPUTS.size)
        ends = (12, 12 + CHANNELS, 12 + 2 * CHANNELS)
        state, fault, _, delay = made[ends[2] + 5:ends[2] + 9]
        periods.append(Period(given[:3], given[3:6], given[9:15], made[:3], made[3:6], made[6:9], made[9:12],
                              given[15:15 + CHANNELS], given[15 + CHANNELS:15 + 2 * CHANNELS],
                              made[ends[0]:ends[1]], made[ends[1]:ends[2]], state, fault, delay, made[ends[2]:ends[2] + 5]))
    return periods
