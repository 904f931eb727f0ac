"""The controller of Lee, Cho and Jeon (2005) in numpy: a network that predicts the contour error, and its inversion.

The equations are numbered as in the paper; `docs/method.md` of the project explains them, and what departs from them.
`python lee_cho_jeon_2005.py MODEL PROGRAM [MACHINE]` cuts a program with the weights of a model file. One is written by

    feedwright identify --machine tnv40 --controller two-dimensional --out tnv40.model.toml
"""

import sys
import tomllib

import numpy

from feedwright import lab

#: What the network sees as 1: a feedrate, mm/s, and an error, mm.
FEED_MM_S, ERROR_MM = 50.0, 0.1
#: Below this feedrate (mm/s) there is no direction to correct in; below the other (scaled) the term of rho is left out.
STANDING_MM_S, SLOW = 0.05, 0.02
#: Part of the offset that is taken back in a feed period: along the path, and at rest.
ALONG_LEAK, REST_LEAK = 0.05, 0.3


def activation(x):
    """The bipolar sigmoid."""
    return numpy.tanh(x / 2)


def slope(f):
    """Its derivative, given its value."""
    return (1 - f * f) / 2


class Network:
    """Predicts the contour error of each axis from F(k), F(k-1), F(k-2), eps(k-1), eps(k-2) of all axes."""

    def __init__(self, hidden, output):
        self.hidden, self.output = numpy.array(hidden), numpy.array(output)

    @classmethod
    def read(cls, path):
        """The weights of a model file."""
        with open(path, "rb") as file:
            model = tomllib.load(file)
        axes, weights = model["axes"], model["weights"]
        return cls(numpy.reshape(weights["hidden"], (axes, 5, -1)), numpy.reshape(weights["output"], (axes, -1)))

    def copy(self):
        return Network(self.hidden, self.output)

    def predict(self, inputs):
        """Eqs 3 to 5: the hidden nodes and the error, scaled. `inputs` has a row for each axis."""
        nodes = activation(numpy.tensordot(inputs, self.hidden, 2))
        return nodes, activation(self.output @ nodes)

    def learn(self, inputs, error, step):
        """One step of back-propagation down eq. 6."""
        nodes, predicted = self.predict(inputs)
        delta = (error - predicted) * slope(predicted) * step
        hidden_delta = (delta @ self.output) * slope(nodes)
        self.output += numpy.outer(delta, nodes)
        self.hidden += inputs[:, :, None] * hidden_delta

    def invert(self, inputs, rho, eta, steps, step_limit):
        """Eqs 7 to 10: the feedrate F(k), scaled, after some gradient steps."""
        inputs = inputs.copy()
        for _ in range(steps):
            feed = inputs[:, 0]
            nodes, error = self.predict(inputs)
            # Eqs 9 and 10 have the diagonal of the Jacobian, and this sign.
            diagonal = slope(error) * ((self.output * slope(nodes)) * self.hidden[:, 0]).sum(axis=1)
            gradient = -error * diagonal
            square = feed @ feed
            if square >= SLOW**2:
                gradient = gradient - 2 * rho * feed / square**2
            move = -eta * gradient
            length = numpy.linalg.norm(move)
            inputs[:, 0] = feed + (move if length <= step_limit else move * (step_limit / length))
        return inputs[:, 0]


class TwoDimensional:
    """Speed and geometry by inversion of the network, which goes on learning."""

    servo_periods, preview = 10, 1

    def __init__(self, network, rho=0.001, eta=0.3, steps=5, step_limit=0.1, learning_step=0.003):
        self.trained, self.learning_step = network, learning_step
        self.inversion = (rho, eta, steps, step_limit)
        self.reset()

    def reset(self):
        self.network = self.trained.copy()
        axes = len(self.trained.output)
        # F(k-1), F(k-2), eps(k-1), eps(k-2) of each axis.
        self.delays = numpy.zeros((axes, 4))
        self.last = None

    def inputs(self, feed_mm_s):
        return numpy.column_stack([feed_mm_s / FEED_MM_S, self.delays])

    def observe(self, window, measured):
        if measured is None or self.last is None:
            return
        error = measured.contour_error_mm / ERROR_MM
        self.network.learn(self.last, error, self.learning_step)
        before = self.delays
        self.delays = numpy.column_stack([self.last[:, 0], before[:, 0], error, before[:, 2]])

    def command(self, window):
        period_s, offset_mm = window.feed_period_s, window.offset_mm
        planned = (window.path_mm[1] - window.path_mm[0]) / period_s
        planned_feed = numpy.linalg.norm(planned)
        self.last = self.inputs(planned)
        if planned_feed < STANDING_MM_S:
            return 1.0, (1 - REST_LEAK) * offset_mm
        direction = planned / planned_feed
        change = self.network.invert(self.last, *self.inversion) * FEED_MM_S - planned
        along = change @ direction
        across = change - along * direction
        rate = min(max(1 + along / planned_feed, 0.5), 1.2)
        self.last = self.inputs(across + rate * planned)
        stale = ALONG_LEAK * (offset_mm @ direction)
        return rate, offset_mm + period_s * across - stale * direction


if __name__ == "__main__":
    model, program, *machine = sys.argv[1:]
    print(lab.run(program, *(machine or ["tnv40"]), TwoDimensional(Network.read(model))))
