import os
from typing import Any, Callable, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

__version__: str

_Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]
# Frames x joints x 10: translation, rotation x y z w, scale, relative to the parent; or skinning matrices, frames x
# joints x 3 x 4, rest space to world.
_Joints = Union[NDArray[np.float64], NDArray[np.float32]]

class Error(RuntimeError):
    """What the library refuses: bad files (code 4), things that do not belong together (3), devices (5), usage (64)."""

    code: int
    result: Any
    """Of run(): the JSON that the verb wrote, or None."""

class Skin:
    """Of frames F: positions and normals F x V x 3, strains F x S, outside and fades F.

    outside: how far the worst feature lies outside its trained range, in standard deviations; 0: the pose is covered.
    fades: how much is left of what was learned, 0 to 1.
    expected_errors: how far off the skin is expected to be, F, RMS over the skin, metres; None where the model was
    trained without shapes and does not know.
    tangents: F x V x 4, the tangent and the bitangent's sign, by the convention of MikkTSpace; None where the model was
    loaded without texture coordinates. normals and tangents are None where they were not wanted.
    vertex_errors: expected_errors of each vertex, F x V, metres; None where they were not wanted.
    outside_features: F, the number of the feature that lies outside in Model.feature_names; -1 where outside is 0.
    excess: how far each of Model.feature_names lies outside, F x features, as outside does.
    attached: of each of Model.attached F x N x 3, metres; None where there are none, or they were not wanted.
    full_positions: F x Model.full_vertex_count x 3, metres; None where they were not wanted.
    """

    @property
    def positions(self) -> NDArray[np.float32]: ...
    @property
    def normals(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def strains(self) -> NDArray[np.float32]: ...
    @property
    def outside(self) -> NDArray[np.float32]: ...
    @property
    def fades(self) -> NDArray[np.float32]: ...
    @property
    def expected_errors(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def tangents(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def vertex_errors(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def outside_features(self) -> NDArray[np.float32]: ...
    @property
    def excess(self) -> NDArray[np.float32]: ...
    @property
    def attached(self) -> Optional[list[NDArray[np.float32]]]: ...
    @property
    def full_positions(self) -> Optional[NDArray[np.float32]]: ...

class State:
    """The jiggle of an instance at one moment."""

class Device:
    @property
    def name(self) -> str: ...

class Instance:
    """Evaluates a model. Calls from several threads wait for one another; other Python threads run meanwhile."""

    def evaluate(
        self,
        joints: _Joints,
        controls: Optional[NDArray[np.float32]] = None,
        *,
        positions: Optional[NDArray[np.float32]] = None,
        normals: Union[NDArray[np.float32], bool, None] = True,
        tangents: Union[NDArray[np.float32], bool, None] = True,
        frames_per_second: Optional[float] = None,
        channels: Optional[NDArray[np.float32]] = None,
        goes_on: bool = False,
        vertex_errors: bool = False,
        attached: bool = True,
        full_positions: bool = False,
    ) -> Skin:
        """The quasi-static skin. joints: F x J x 10, or skinning matrices; controls: F x C. Written to positions, normals
        and tangents where given. False leaves normals or tangents out, which saves their time; tangents need texture coordinates.

        With frames_per_second the character's modifiers are shown, by channels (F x Model.channels; None: their
        constants); the frames are consecutive, and go on from those before where goes_on says so. vertex_errors: of a
        model that knows_error, or Error(3). full_positions: of a level that carries the full skin, or Error(64)."""
    def jiggle(
        self,
        joints: _Joints,
        frame_numbers: Sequence[int],
        controls: Optional[NDArray[np.float32]] = None,
        *,
        positions: Optional[NDArray[np.float32]] = None,
        normals: Union[NDArray[np.float32], bool, None] = True,
        tangents: Union[NDArray[np.float32], bool, None] = True,
        frames_per_second: Optional[float] = None,
        channels: Optional[NDArray[np.float32]] = None,
        goes_on: bool = False,
        attached: bool = True,
        full_positions: bool = False,
    ) -> Skin:
        """The skin with jiggle; it goes on from the frames of earlier calls. Modifiers as by evaluate()."""
    def skip(
        self,
        joints: _Joints,
        frames_per_second: float,
        channels: Optional[NDArray[np.float32]] = None,
        *,
        goes_on: bool = False,
    ) -> None:
        """Has modifiers go on past frames as by evaluate(), without the time of a skin."""
    def set_weights(self, correction: float = 1, jiggle: float = 1) -> None:
        """How much is shown of what was learned, and of the jiggle: each -1000 to 1000."""
    def state(self) -> State: ...
    def set_state(self, state: Optional[State]) -> None: ...
    def save_state(self, state: State, path: _Path) -> None: ...
    def load_state(self, path: _Path) -> State: ...

class Call:
    """What one instance does among others, by evaluate_together.

    With frame_numbers as Instance.jiggle, without them as Instance.evaluate, whose arguments these are. Evaluated again, it
    writes the same arrays.
    """

    def __init__(
        self,
        instance: Instance,
        joints: _Joints,
        controls: Optional[NDArray[np.float32]] = None,
        frame_numbers: Optional[Sequence[int]] = None,
        *,
        positions: Optional[NDArray[np.float32]] = None,
        normals: Union[NDArray[np.float32], bool, None] = True,
        tangents: Union[NDArray[np.float32], bool, None] = True,
        attached: bool = True,
        full_positions: bool = False,
    ) -> None: ...
    @property
    def skin(self) -> Optional[Skin]:
        """None before the call is evaluated, and where that failed."""

class Model:
    """The tables of a character: constant, used by any number of instances."""

    @property
    def vertex_count(self) -> int: ...
    @property
    def has_dynamics(self) -> bool: ...
    @property
    def has_tangents(self) -> bool:
        """Whether skins have tangents."""
    @property
    def knows_error(self) -> bool:
        """Whether skins have expected_errors."""
    @property
    def frames_per_second(self) -> float:
        """At which instances jiggle; 0 without dynamics."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def joint_parents(self) -> list[int]: ...
    @property
    def control_names(self) -> list[str]: ...
    @property
    def channels(self) -> list[tuple[str, str, float, float, float]]:
        """Of the character's modifiers: name, what it is, constant, low, high."""
    @property
    def attached(self) -> list[tuple[str, NDArray[np.uint32]]]:
        """Of the meshes that are attached to the skin: name, T x 3 triangles."""
    @property
    def full_vertex_count(self) -> int:
        """Of a level of detail that carries the full skin: vertices of that; 0 of others."""
    @property
    def feature_names(self) -> list[str]:
        """Of what the learned part reads: "joint elbow", "place of joint elbow", "strain biceps/1"."""
    @property
    def strain_names(self) -> list[str]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def bind_pose(self) -> NDArray[np.float64]:
        """J x 10: translation x y z, rotation x y z w, scale x y z, relative to the parent."""
    def instance(
        self,
        device: Optional[Device] = None,
        *,
        jiggles: bool = False,
        iterations: int = 0,
        gravity_change: tuple[float, float, float] = (0, 0, 0),
        check: bool = False,
    ) -> Instance:
        """On a Vulkan device, or the CPU without one.

        iterations: has no effect, of a mode that there was. gravity_change: m/s^2, world, each -1000 to 1000.
        check: every stage on the device beside the same on the CPU; the first difference raises Error(5).
        """

def evaluate_together(calls: Sequence[Call]) -> None:
    """Many instances at once, each in one call only: one submission for all that are on one device.

    Raises Error, which names those that failed by their number ("call 3: ..."); the others are right all the same.
    """

def load(
    path: _Path,
    dynamics: Optional[_Path] = None,
    level: int = 0,
    texture: Optional[NDArray[np.float32]] = None,
    attached: Optional[_Path] = None,
) -> Model:
    """A character. texture: V x 2 texture coordinates, of the vertices of this level, for skins with tangents.
    attached: the file of its attached meshes, which follow level 0.

    Raises Error(3), too, for texture coordinates of another number of vertices.
    """
def load_from_memory(
    data: bytes,
    dynamics: Optional[bytes] = None,
    level: int = 0,
    texture: Optional[NDArray[np.float32]] = None,
    attached: Optional[bytes] = None,
) -> Model:
    """As load(), of the bytes of the files."""
def device_names() -> list[str]:
    """Of the Vulkan devices of this machine, in the order of their indices; empty without Vulkan."""
def open_device(
    name: Optional[str] = None, validation: bool = False, pipeline_cache: Optional[_Path] = None
) -> Device:
    """The Vulkan device of this index or part of a name, or the best one.

    pipeline_cache: folder where the driver's compiled shaders are kept, so that later processes start sooner."""
def run(
    verb: str,
    *arguments: Union[str, os.PathLike[str]],
    progress: Optional[Callable[[str, int, int, float], None]] = None,
    cancelled: Optional[Callable[[], bool]] = None,
    **options: Any,
) -> Any:
    """Runs a verb of the program and returns its JSON: run("eval", "hero.safetensors", clip="walk.glb", out="walk.pc2").

    Options are --out FILE for out="FILE", --jiggle for jiggle=True, --a-b for a_b, and the items of a list. progress(what,
    done, total, seconds) is called about once a second; cancelled() is asked several times a second, and ends the verb where it is
    true. Raises Error with the verb's exit code: 75 where it was cancelled."""
