"""Cross-checks of samples that begin and end anywhere in the motion of a scene."""

from functools import partial

from symosc.crosschecks import compare

crosscheck = partial(compare.crosscheck, own_start=True, partial=True)
