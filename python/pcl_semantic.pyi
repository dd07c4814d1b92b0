"""Semantic 3D occupancy maps, and a CRF over labelled clouds."""

import os
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]

__version__: str

def refine(
    points: ArrayLike,  # N x 3 [m]
    *,
    probabilities: Optional[ArrayLike] = None,  # N x L, column k is class k + 1
    labels: Optional[ArrayLike] = None,  # N, 0 = unlabelled
    colours: Optional[ArrayLike] = None,  # N x 3, red, green, blue
    cliques: Union[None, str, ArrayLike] = None,  # N numbers, 0 = none; or "planes"
    classes: int = 0,  # L, for labels; 0 = the largest label
    thin: Sequence[int] = (),  # labels of poles and the like, see crf_keep_thin
    **parameters: Any,  # those of pcl_semantic_crf: smoothness_weight=3.0
) -> Tuple[NDArray[np.uint8], NDArray[np.float32]]: ...
def cliques(
    points: ArrayLike, kind: str = "planes", *, colours: Optional[ArrayLike] = None
) -> NDArray[np.int32]: ...
def planes(
    points: ArrayLike,  # N x 3 [m]
    *,
    labels: Optional[ArrayLike] = None,
    radius: float = 0.0,  # [m]; 0 = automatic
    distance: float = 0.0,
    min_area: float = 0.0,  # [m^2]
) -> Tuple[NDArray[np.uint32], List[Dict[str, Any]]]: ...
def objects(
    points: ArrayLike, labels: ArrayLike, *, gap: float = 0.7, min_points: int = 20
) -> NDArray[np.int32]: ...
def confusion_matrix(
    truth: ArrayLike, prediction: ArrayLike, classes: int
) -> NDArray[np.uint64]: ...
def scores(confusion: ArrayLike) -> Dict[str, Any]: ...
def read_cloud(
    path: Path, *, scan_columns: Union[None, str, int, Sequence[str]] = None
) -> Dict[str, NDArray[Any]]: ...
def write_cloud(path: Path, cloud: Dict[str, ArrayLike]) -> None: ...
def read_camera(path: Path) -> Dict[str, float]: ...
def load_map(path: Path) -> SemanticVoxelMap: ...

pixel_feature_names: Tuple[str, ...]

def pixel_features(
    left: ArrayLike,  # H x W or H x W x 3, uint8
    right: ArrayLike,
    camera: Sequence[float],  # fx fy cx cy baseline width height
    probabilities: ArrayLike,  # H*W x L, of the left image
    *,
    ground: Sequence[int] = (),  # labels of the ground
    **parameters: Any,  # stereo, disparities and max_deviation of pcl_semantic_map
) -> NDArray[np.float32]: ...  # H x W x 7, NaN = unknown

class SemanticVoxelMap:
    def __init__(self, label_set: Path, **parameters: Any) -> None: ...
    def integrate(
        self,
        points: ArrayLike,  # N x 3, sensor frame [m]
        pose: ArrayLike,  # 4 x 4, T_world_sensor
        *,
        probabilities: Optional[ArrayLike] = None,
        colours: Optional[ArrayLike] = None,
    ) -> Dict[str, int]: ...
    def move_window(self, centre: ArrayLike) -> None: ...
    def voxels(self) -> Dict[str, NDArray[Any]]: ...
    def labels(self, points: ArrayLike) -> NDArray[np.uint8]: ...
    def write(self, path: Path, class_colours: bool = False) -> None: ...
    def save(self, path: Path) -> None: ...

class SemanticMapper:
    def __init__(
        self,
        label_set: Path,
        camera: Optional[Sequence[float]] = None,  # fx fy cx cy baseline width height
        **parameters: Any,  # those of pcl_semantic_map: crf="hierarchical"
    ) -> None: ...
    def process(
        self,
        points: ArrayLike,
        pose: ArrayLike,
        *,
        probabilities: Optional[ArrayLike] = None,
        colours: Optional[ArrayLike] = None,
    ) -> Dict[str, Any]: ...
    def process_pair(
        self, left: ArrayLike, right: ArrayLike, pose: ArrayLike, probabilities: ArrayLike
    ) -> Dict[str, Any]: ...
    def process_rgbd(
        self,
        image: ArrayLike,  # H x W, or x 3
        depths: ArrayLike,  # H x W [m]; 0 or NaN = none
        pose: ArrayLike,  # 4 x 4, T_world_camera
        *,
        probabilities: Optional[ArrayLike] = None,
    ) -> Dict[str, Any]: ...
    def finish(self) -> None: ...
    def voxels(self) -> Dict[str, NDArray[Any]]: ...
    def labels(self, points: ArrayLike) -> NDArray[np.uint8]: ...
    def write(self, path: Path, class_colours: bool = False) -> None: ...
    def save(self, path: Path) -> None: ...
