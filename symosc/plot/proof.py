"""Figure of a certificate: how narrow its enclosures are."""

from __future__ import annotations

from decimal import Decimal

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.certificates.certificate import Certificate
from symosc.errors import ParameterError
from symosc.plot.drawing import one_axes, style_for

#: Name, colour and shape of the two enclosures of an event.
ENCLOSED = (("time $t$", "#1f3fd6", "o"), ("position $x$", "#d7191c", "s"))
#: Where enclosures of no width are drawn: below what a certificate ever has.
NO_WIDTH = 1e-30


@public
def certificate_figure(certificate: Certificate, *, ax: Axes | None = None) -> Figure:
    """Draw how wide the proven enclosures of an orbit's or a motion's events are, against time.

    Parameters
    ----------
    certificate : Certificate
        Of a trajectory or an orbit; what is proven of a branch or a window are no events.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If that is no Certificate, or has no enclosures of events, or `ax` are no axes.

    Examples
    --------
    >>> from symosc import certify, plot
    >>> plot.certificate_figure(certify("fig6")).axes[0].get_ylabel()
    'width of the enclosure'
    """
    events = [event for event in certificate.events if len(event) > 3]
    if not events:
        allowed = "has no enclosed events to draw; those of a trajectory or an orbit with events do"
        raise ParameterError("certificate", certificate, allowed)
    times = [float(event[3][0]) for event in events]
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.0))
        for i, (name, color, shape) in enumerate(ENCLOSED):
            widths = [max(float(Decimal(high) - Decimal(low)), NO_WIDTH) for low, high in (e[3 + i] for e in events)]
            axes.semilogy(times, widths, marker=shape, ms=3.5, lw=0.8, color=color, label=name)
        axes.set(xlabel="time $t$", ylabel="width of the enclosure")
        axes.set_title(f"{certificate.kind}, {'proven' if certificate.proven else 'not proven'}")
        axes.legend(frameon=False)
    return drawing
