"""What notebooks show of each answer: a line, a short table, and a small picture where that takes milliseconds.

May import: everything up to certificates, and nothing that draws; figures are what ``.plot()`` is for.

One more answer: a function that returns a page (`symosc.display.html`), registered here for its class.
"""

from symosc.certificates.certificate import Certificate
from symosc.crosschecks.report import CrossCheck
from symosc.display.drawable import register_page
from symosc.grazing.window import GrazingWindow
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.plot.notebooks.judged import certificate_page, crosscheck_page
from symosc.plot.notebooks.motions import events_page, summary_page, trajectory_page
from symosc.plot.notebooks.structures import branch_page, orbit_page, window_page
from symosc.simulation.tables import EventTable, Summary
from symosc.simulation.trajectory import Trajectory

register_page(Trajectory, trajectory_page)
register_page(EventTable, events_page)
register_page(Summary, summary_page)
register_page(PeriodicOrbit, orbit_page)
register_page(Branch, branch_page)
register_page(GrazingWindow, window_page)
register_page(CrossCheck, crosscheck_page)
register_page(Certificate, certificate_page)
