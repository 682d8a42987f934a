# The public names of symosc and where each is written: the only list of them. Loaded on first use.
from . import plot as plot
from .certificates.atlas import Atlas as Atlas
from .certificates.atlas import atlas as atlas
from .certificates.certificate import Certificate as Certificate
from .certificates.certify import certify as certify
from .crosschecks.causes import Fault as Fault
from .crosschecks.compare import CrossCheck as CrossCheck
from .crosschecks.compare import crosscheck as crosscheck
from .crosschecks.events import FoundEvent as FoundEvent
from .crosschecks.events import Match as Match
from .display.drawable import Listing as Listing
from .engine.events import Event as Event
from .errors import (
    MissingExtraError as MissingExtraError,
)
from .errors import (
    OutputError as OutputError,
)
from .errors import (
    ParameterError as ParameterError,
)
from .errors import ResultError as ResultError
from .errors import (
    SceneError as SceneError,
)
from .errors import SweepError as SweepError
from .errors import (
    SymoscError as SymoscError,
)
from .fit import Fit as Fit
from .fit import fit as fit
from .grazing.check import GrazingReport as GrazingReport
from .grazing.check import check_grazing as check_grazing
from .grazing.curve import (
    CurveEnd as CurveEnd,
)
from .grazing.curve import (
    CurvePiece as CurvePiece,
)
from .grazing.curve import (
    GrazingCurve as GrazingCurve,
)
from .grazing.curve import (
    grazing_curve as grazing_curve,
)
from .grazing.solve import GrazingSolutions as GrazingSolutions
from .grazing.solve import solve_grazing as solve_grazing
from .grazing.start import GrazingStart as GrazingStart
from .grazing.start import GrazingVerdict as GrazingVerdict
from .grazing.start import grazing_start as grazing_start
from .grazing.start import is_grazing as is_grazing
from .grazing.window import GrazingWindow as GrazingWindow
from .grazing.window import WindowColumns as WindowColumns
from .grazing.window import grazing_window as grazing_window
from .grazing.window import grazing_windows as grazing_windows
from .mappings.compiled import CompiledResidual as CompiledResidual
from .mappings.compiled import compiled_residual as compiled_residual
from .mappings.equations import MapError as MapError
from .mappings.equations import MapPoint as MapPoint
from .mappings.equations import (
    jacobian as jacobian,
)
from .mappings.equations import (
    parameter_jacobian as parameter_jacobian,
)
from .mappings.equations import (
    residual as residual,
)
from .mappings.equations import solve_map as solve_map
from .mappings.theorem7_cases import Place as Place
from .model import Parameters as Parameters
from .orbits.admissibility import Condition as Condition
from .orbits.border import Border as Border
from .orbits.border import BorderEnd as BorderEnd
from .orbits.border import BorderError as BorderError
from .orbits.border import SpecialPoint as SpecialPoint
from .orbits.border import continue_border as continue_border
from .orbits.branch import Branch as Branch
from .orbits.branch import BranchEnd as BranchEnd
from .orbits.branch import BranchError as BranchError
from .orbits.branch import continue_orbit as continue_orbit
from .orbits.closing_equations import ConvergenceError as ConvergenceError
from .orbits.find import find_orbit as find_orbit
from .orbits.periodic_orbit import (
    Approach as Approach,
)
from .orbits.periodic_orbit import (
    OrbitSensitivities as OrbitSensitivities,
)
from .orbits.periodic_orbit import (
    PeriodicOrbit as PeriodicOrbit,
)
from .orbits.periodic_orbit import (
    SwitchingPoint as SwitchingPoint,
)
from .reductions import OtherModel as OtherModel
from .reference.case import KnownEvent as KnownEvent
from .reference.case import ReferenceCase as ReferenceCase
from .reference.cases import reference_cases as reference_cases
from .response import FrequencyResponse as FrequencyResponse
from .response import frequency_response as frequency_response
from .scenes import Original as Original
from .scenes import Scene as Scene
from .scenes import load_scene as load_scene
from .scenes import scene_names as scene_names
from .sensitivities import Sensitivities as Sensitivities
from .sensitivities import sensitivities as sensitivities
from .simulation.ensemble import EventTable as EventTable
from .simulation.ensemble import Summary as Summary
from .simulation.ensemble import simulate_many as simulate_many
from .simulation.moved import MovedTrajectory as MovedTrajectory
from .simulation.simulate import simulate as simulate
from .simulation.trajectory import Segment as Segment
from .simulation.trajectory import Trajectory as Trajectory
from .sweeps.sweep import SweepStatus as SweepStatus
from .sweeps.sweep import sweep as sweep
from .sweeps.sweep import sweep_status as sweep_status
from .symbolic.inverse import (
    Answer as Answer,
)
from .symbolic.inverse import (
    Answers as Answers,
)
from .symbolic.inverse import GrazingQuestion as GrazingQuestion
from .symbolic.inverse import (
    ParameterRegion as ParameterRegion,
)
from .symbolic.inverse import (
    ParameterValues as ParameterValues,
)
from .symbolic.inverse import (
    values_containing as values_containing,
)
from .symbolic.inverse import (
    values_empty as values_empty,
)
from .symbolic.inverse import (
    values_everything as values_everything,
)
from .symbolic.theorem7 import Case as Case
from .symbolic.theorem7 import Theorem7Cases as Theorem7Cases
from .symbolic.theorem7 import theorem7 as theorem7
from .words import Word as Word
from .words import WordError as WordError
from .words import read_word as read_word

__version__: str
