"""The public names, which `__init__.py` loads when they are first used."""

import pathlib

from . import core as core
from .comparison import Comparison as Comparison
from .comparison import compare as compare
from .errors import BeyondModelWarning as BeyondModelWarning
from .errors import CallError as CallError
from .errors import DeformableError as DeformableError
from .errors import FileError as FileError
from .errors import JumpWarning as JumpWarning
from .errors import LackingWarning as LackingWarning
from .errors import LammpsError as LammpsError
from .errors import ParameterError as ParameterError
from .errors import StalledWarning as StalledWarning
from .errors import UndefinedError as UndefinedError
from .errors import UnjammedWarning as UnjammedWarning
from .errors import UnsavedWarning as UnsavedWarning
from .friction import Friction as Friction
from .generators import bidisperse as bidisperse
from .generators import crystal as crystal
from .generators import polydisperse as polydisperse
from .jamming import jam as jam
from .laws import Droplet as Droplet
from .laws import Ring as Ring
from .laws import Sector as Sector
from .laws import SoftContact as SoftContact
from .packing import Packing as Packing
from .parallel import jackknife as jackknife
from .parallel import parallel_map as parallel_map
from .polygons import DeformablePolygon as DeformablePolygon
from .run import Run as Run
from .simulation import Simulation as Simulation
from .state import State as State
from .surface_evolver import Evolved as Evolved
from .walls import BoxWall as BoxWall
from .walls import Cone as Cone
from .walls import Cylinder as Cylinder
from .walls import Plane as Plane
from .walls import PolygonWall as PolygonWall
from .walls import Segment as Segment
from .walls import Sphere as Sphere

__version__: str
potentials: pathlib.Path
