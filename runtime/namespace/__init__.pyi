from .generated.errors import LtcgearError as LtcgearError
from .runtime.api.gearbox import Gearbox as Gearbox
from .runtime.api.gearbox import load as load
from .runtime.api.gearbox import read_result as read_result
from .runtime.api.mode_list import ModeList as ModeList
from .runtime.api.simulation_result import SimulationResult as SimulationResult
from .symbolic.scene.builder import SceneBuilder as SceneBuilder
from .symbolic.scene.load import shipped_scenes as shipped_scenes

__version__: str
