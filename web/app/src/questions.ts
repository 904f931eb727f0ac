// Six questions for a machine, where there is no machine file yet: all else is as on a machine that is built in.

import { $, element, save } from "./dom";
import { INCH_MM, type Units, getUnits } from "./units";

export const NAME = "mine.toml";

type Unit = (length: Units) => string;
const PER_MINUTE: Unit = (length) => `${length}/min`, LENGTH: Unit = (length) => length;

/** A question, and the answer that the machine `workshop` has, in mm. */
const QUESTIONS: { name: string; asks: string; unit: Unit; value: number; least: number; most: number; help: string }[] = [
  { name: "feed", asks: "Fastest cutting feed", unit: PER_MINUTE, value: 12000, least: 1, most: 6e5, help: "A higher F is cut at this." },
  { name: "rapid", asks: "Rapid", unit: PER_MINUTE, value: 12000, least: 1, most: 6e5, help: "Speed of G0." },
  { name: "accel", asks: "Acceleration of an axis", unit: (length) => `${length}/s²`, value: 2000, least: 1, most: 1e5, help: "LinuxCNC: MAX_ACCELERATION." },
  { name: "lead", asks: "Travel in one turn of the motor", unit: LENGTH, value: 10, least: 0.1, most: 500, help: "Lead of the screw, or of pulley and belt." },
  { name: "lag", asks: "Following error at the fastest feed", unit: LENGTH, value: 0.2, least: 0.0001, most: 50, help: "LinuxCNC: joint.N.f-error while the axis moves." },
  { name: "servo", asks: "Servo period", unit: () => "ms", value: 1, least: 0.1, most: 10, help: "LinuxCNC: SERVO_PERIOD / 1,000,000." },
];

/** Position gain of `workshop`, 1/s. */
const GAIN_1_S = 50;

/** The loop that lags by `lag_mm` at `feed_mm_s`: by its gain without feedforward, or by feedforward where that lag is too small for it. */
function loop(lag_mm: number, feed_mm_s: number): { gain_1_s: number; feedforward: number } {
  const gain_1_s = Math.min(feed_mm_s / lag_mm, GAIN_1_S);
  return { gain_1_s, feedforward: 1 - (gain_1_s * lag_mm) / feed_mm_s };
}

/** The machine file of the answers, in mm, mm/min and ms. */
function machineFile(answers: Record<string, number>): string {
  const round = (value: number) => Number(value.toPrecision(9));
  const [feed, rapid] = [answers.feed / 60, answers.rapid / 60], { gain_1_s, feedforward } = loop(answers.lag, feed);
  const axis = Object.entries({
    lead_mm_per_rev: answers.lead,
    kp_1_s: gain_1_s,
    velocity_feedforward: feedforward,
    max_velocity_mm_s: Math.max(feed, rapid),
    max_accel_mm_s2: answers.accel,
    max_jerk_mm_s3: answers.accel / 0.04,
  }).map(([key, value]) => `${key} = ${round(value)}\n`).join("");
  return `# From six numbers; everything that is not here is that of workshop. A log of the machine tells it better: feedwright excite.

base = "workshop"
name = "mine"
description = "six numbers of a machine; the rest is that of workshop"
source = "answers to six questions"

[period]
servo_s = ${round(answers.servo / 1e3)}

[limits]
rapid_mm_s = ${round(rapid)}
max_feed_mm_s = ${round(feed)}
tangential_accel_mm_s2 = ${round(answers.accel)}
normal_accel_mm_s2 = ${round(answers.accel)}
${["x", "y", "z"].map((name) => `\n[axis.${name}] # the jerk reaches the acceleration in 40 ms\n${axis}`).join("")}`;
}

/** Asks, and calls `use` with the text of the machine file. */
export function listenToQuestions(use: (text: string) => void): void {
  const dialog = $<HTMLDialogElement>("questions"), form = dialog.querySelector("form")!;
  let asked: Units | undefined;
  const factor = (unit: Unit) => (unit("mm") === unit("in") || asked === "mm" ? 1 : INCH_MM);
  const ask = () => {
    if (asked === getUnits()) return;
    asked = getUnits();
    $("asked").replaceChildren(...QUESTIONS.map(({ name, asks, unit, value, least, most, help }) => {
      const label = element("label"), input = element("input"), by = factor(unit);
      Object.assign(input, { name, type: "number", required: true, step: "any", value: String(Number((value / by).toPrecision(4))), min: String(least / by), max: String(most / by) });
      label.append(element("span", asks), input, element("span", unit(asked!)), element("small", help));
      return label;
    }));
  };
  const text = () => {
    const given = new FormData(form);
    return machineFile(Object.fromEntries(QUESTIONS.map(({ name, unit }) => [name, Number(given.get(name)) * factor(unit)])));
  };
  $("describe").addEventListener("click", () => { ask(); dialog.showModal(); });
  $("unasked").addEventListener("click", () => dialog.close());
  $("described").addEventListener("click", () => form.reportValidity() && save(NAME, new Blob([text()])));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    dialog.close();
    use(text());
  });
}
