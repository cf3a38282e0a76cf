"""The public names, which `__init__.py` loads when they are first used."""

import pathlib

from . import core as core
from .common.errors import AbsentWarning as AbsentWarning
from .common.errors import BeyondModelWarning as BeyondModelWarning
from .common.errors import CallError as CallError
from .common.errors import DeformableError as DeformableError
from .common.errors import FileError as FileError
from .common.errors import JumpWarning as JumpWarning
from .common.errors import LackingWarning as LackingWarning
from .common.errors import LammpsError as LammpsError
from .common.errors import OpeningWarning as OpeningWarning
from .common.errors import ParameterError as ParameterError
from .common.errors import StalledWarning as StalledWarning
from .common.errors import UndefinedError as UndefinedError
from .common.errors import UnjammedWarning as UnjammedWarning
from .common.errors import UnsavedWarning as UnsavedWarning
from .common.jackknife import jackknife as jackknife
from .common.parallel import parallel_map as parallel_map
from .common.ranks import show_progress as show_progress
from .common.versions import show_versions as show_versions
from .engine.jamming import jam as jam
from .engine.moduli import ElasticModuli as ElasticModuli
from .engine.relax import Iteration as Iteration
from .engine.simulation import Simulation as Simulation
from .formats.surface_evolver import Evolved as Evolved
from .particles.friction import Friction as Friction
from .particles.generators import bidisperse as bidisperse
from .particles.generators import crystal as crystal
from .particles.generators import polydisperse as polydisperse
from .particles.laws import Droplet as Droplet
from .particles.laws import Ring as Ring
from .particles.laws import Sector as Sector
from .particles.laws import SoftContact as SoftContact
from .particles.packing import Packing as Packing
from .particles.polygons import DeformablePolygon as DeformablePolygon
from .particles.walls import BoxWall as BoxWall
from .particles.walls import Cone as Cone
from .particles.walls import Cylinder as Cylinder
from .particles.walls import Plane as Plane
from .particles.walls import PolygonWall as PolygonWall
from .particles.walls import Segment as Segment
from .particles.walls import Sphere as Sphere
from .particles.walls import SurfaceWall as SurfaceWall
from .protocols.motion import Alignment as Alignment
from .protocols.protocol import Protocol as Protocol
from .protocols.shearing import DynamicModulus as DynamicModulus
from .reference.comparison import Comparison as Comparison
from .reference.comparison import compare as compare
from .runs.run import Run as Run
from .runs.run import Table as Table
from .state.derivatives import Derivatives as Derivatives
from .state.displacements import LocalStrain as LocalStrain
from .state.hessian_matrix import Hessian as Hessian
from .state.modes import Modes as Modes
from .state.secondary_contacts import SecondaryOutlines as SecondaryOutlines
from .state.state import State as State
from .state.voronoi import Cells as Cells

__version__: str
potentials: pathlib.Path
