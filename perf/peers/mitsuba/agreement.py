"""Tests whether two sets of noisy pictures show the same scene. Pictures are arrays (run, row, column,
channel) of linear RGB.

Runs are independent of each other; the samples inside a run need not be. Must not depend on any renderer.
"""

import numpy as np
from scipy import stats

CHANNELS = "RGB"
# Probability of a false alarm: once for the means, once for all blocks of a picture together.
FALSE_ALARM = 1e-3
# Relative rounding error of sums in single precision, as in Mitsuba's film. Added to every standard error.
ROUNDING = 1e-5


def student(ours, theirs):
    """Difference, its standard error, t and the two-sided probability of such a t, by Welch's test along
    the first axis.
    """
    difference = ours.mean(0) - theirs.mean(0)
    floor = ROUNDING * np.abs(theirs).mean(0)
    parts = [x.var(0, ddof=1) / len(x) for x in (ours, theirs)]
    freedom = sum(parts) ** 2 / np.maximum(sum(part**2 / (len(x) - 1) for part, x in zip(parts, (ours, theirs))), 1e-300)
    error = np.sqrt(sum(parts) + floor**2)
    t = np.divide(difference, error, out=np.where(difference == 0, 0.0, 1e9), where=error > 0)
    return difference, error, t, 2 * stats.t.sf(np.abs(t), np.maximum(freedom, 1))


def corrected(probability, tests):
    """Šidák's correction of the least p among `tests` independent tests; an upper bound if they are
    positively dependent.
    """
    return float(-np.expm1(tests * np.log1p(-min(probability, 1 - 1e-16))))


def blocks_of(pictures, side):
    """The means of blocks of `side`² pixels; those at the right and lower edge may be smaller."""
    starts = [np.arange(0, length, side) for length in pictures.shape[1:3]]
    sums = np.add.reduceat(np.add.reduceat(pictures, starts[0], axis=1), starts[1], axis=2)
    lengths = [np.diff(np.append(start, length)) for start, length in zip(starts, pictures.shape[1:3])]
    return sums / np.multiply.outer(*lengths)[None, :, :, None]


def agreement(ours, theirs, side):
    """The figures by channel, the worst block, and whether the two agree."""
    means = [x.mean((1, 2)) for x in (ours, theirs)]
    difference, error, t, probability = student(*means)
    scale = np.maximum(np.abs(means[1].mean(0)), 1e-300)
    channels = [
        {
            "channel": name, "octray": float(means[0].mean(0)[i]), "mitsuba": float(means[1].mean(0)[i]),
            "relative_difference": float(difference[i] / scale[i]), "standard_error": float(error[i] / scale[i]),
            "z": float(t[i]), "p": float(probability[i]),
        }
        for i, name in enumerate(CHANNELS)
    ]
    blocks = [blocks_of(x, side) for x in (ours, theirs)]
    difference, error, t, probability = student(*blocks)
    row, column, i = np.unravel_index(np.argmin(probability), probability.shape)
    least = float(probability.min())
    worst = {
        "x": int(column) * side, "y": int(row) * side, "channel": CHANNELS[i],
        "octray": float(blocks[0].mean(0)[row, column, i]), "mitsuba": float(blocks[1].mean(0)[row, column, i]),
        "t": float(t[row, column, i]), "p": least, "p_corrected": corrected(least, probability.size),
    }
    beyond_3 = float((np.abs(t) > 3).mean())
    found = {"side": side, "tests": probability.size, "beyond_3": beyond_3, "rms_t": float(np.sqrt((t**2).mean())), "worst": worst}
    mean_p = corrected(min(channel["p"] for channel in channels), len(channels))
    agree = mean_p > FALSE_ALARM and worst["p_corrected"] > FALSE_ALARM
    return {"channels": channels, "means_p_corrected": mean_p, "blocks": found, "agree": bool(agree)}


class GroundTruth:
    """The picture that errors are measured against: the weighted mean of all long runs of both, clipped to
    [0, 1].
    """

    def __init__(self, ours, theirs, seen):
        means = [x.mean(0) for x in (ours, theirs)]
        noise = [x.var(0, ddof=1) / len(x) for x in (ours, theirs)]
        weights = [1 / max(variance.mean(), 1e-300) for variance in noise]
        weights = [weight / sum(weights) for weight in weights]
        mean = sum(weight * picture for weight, picture in zip(weights, means))
        # Pixels that see a light are easy and bright: they do not measure its light elsewhere.
        self.counted = ~seen
        self.picture = np.clip(mean, 0, 1)
        variance = sum(weight**2 * variance for weight, variance in zip(weights, noise)) * (mean < 1)
        self.noise = float(variance[self.counted].mean()) if self.counted.any() else 0.0

    def mean_square(self, picture):
        """Mean square error of a picture of another run, without the noise of the ground truth."""
        if not self.counted.any():
            return 0.0
        error = np.clip(picture, 0, 1) - self.picture
        return max(float((error[self.counted] ** 2).mean()) - self.noise, 1e-300)
