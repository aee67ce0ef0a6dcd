"""What pages and films of motions show: tracks of masses and links, panels and instants."""

import json

import numpy as np
from figure_descriptions import described
from linked_block import block
from recording import Record

import generated.double_pendulum as double
import generated.driven_pendulum as driven
import generated.four_bar as four_bar
import generated.spherical_pendulum as spherical
from solvers import Solution, build, consistent_start, integrate
from solvers.equations.module import GeneratedModule
from solvers.player import film
from solvers.player.sampled_motion import tracks


def moved(module: GeneratedModule, start: object, end: float = 1.0) -> Solution:
    """A motion in few steps of an own length, for which no library is compiled."""
    return integrate(
        module, (0, end), start, module.DEFAULTS, method="rk4", h=0.05, backend="python"
    )


def test_tracks_and_films_are_as_recorded(record: Record) -> None:
    start = consistent_start(four_bar, {"phi": 1.0, "phi_dot": 2.0}, four_bar.DEFAULTS).y
    groups = {
        "double": [moved(double, (1.0, 2.0, 0.0, 0.5)), moved(double, (0.5, 2.0, 0.0, 0.0))],
        "backwards": [moved(double, (1.0, 2.0, 0.0, 0.5), -0.7)],
        "driven": [moved(driven, (1.0, 0.0))],
        "four_bar": [moved(four_bar, start)],
        "links": [moved(build(block()), (0.3, 0.5))],
        "spherical": [moved(spherical, (1.0, 0.0, 0.0, 2.0))],
    }
    texts = {}
    for name, solutions in groups.items():
        motions = [motion for one in solutions for motion in one.sampled_motions()]
        values = [one.json_values() for one in tracks(motions)]
        for one in values:  # small differences of energies have fewer digits
            one["energy_error"] = np.round(np.array(one["energy_error"], float), 8).tolist()
        pieces = [json.dumps({key: one[key]}) for one in values for key in one]
        figures = [film._instants(motions), film._figure(motions, motions[0].t)[0]]
        pieces += map(described, figures)
        pieces += [str(np.round(film.frame_times(one.t[-1] - one.t[0], 0.5), 6)) for one in motions]
        texts[name] = "\n\n".join(pieces)
    record.check_digests(texts)
