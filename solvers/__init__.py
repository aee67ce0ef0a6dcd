"""Integration of generated equations of motion, models of scenes, sweeps and studies.

Generated modules are arguments, so that nothing here needs SymPy.

Modules: `load`, `build`.

Motions: `integrate`, `ensemble`, `prepare`, `ode_solver`, `consistent_start`, `Event`, `Extremum`,
`Held`, `StopFlag`; their results: `Solution`, `Ensemble`, `Status`.

Equilibria and linear systems: `equilibria`, `linearise`, `LinearSystem`.

Periodic orbits: `periodic_orbit`, `orbit_family`, `normal_mode_orbit`, `backbone_slope`.

Perturbations: `lyapunov_spectrum`, `sensitivities`, `Sensitivities`, `transition_matrix`.

Scenes and fits: `load_scene`, `run_scene`, `Scene`, `SceneResult`, `LivePage`; `read_measurement`,
`fit`, `compare`, `Measurement`, `Fit`.

Sweeps: `load_sweep`, `sweep`, `partial_results`, `Sweep`, `Results`, `Pool`; axes: `Grid`,
`Random`, `Table`; maps: `Basins`, `Bifurcation`, `EnergyError`, `Extremes`, `Final`, `First`,
`Lyapunov`, `Response`, `Samples`, `Section`, `Spectrum`, `Stroboscopic`.

Figures: `panels`, `save`.
"""

from pathlib import Path

from solvers.io.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, Path(__file__).with_suffix(".pyi"))
