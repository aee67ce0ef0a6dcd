"""The page plays its tracks in a real browser, and does nothing else."""

import re
import shutil
import threading
from collections.abc import Iterator, Sequence
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest
from browser import UNIT, Player, at_rest, track_of

from solvers.player import player_page
from solvers.player.track import CoordinateTrack, Track

BOBS, ROD = ((0x00, 0x72, 0xB2), (0xD5, 0x5E, 0x00)), (0x4A, 0x52, 0x59)
# runs have the colours after those of their masses
AFTER_ONE, AFTER_TWO = (BOBS[1], (0x00, 0x9E, 0x73)), ((0x00, 0x9E, 0x73), (0xCC, 0x79, 0xA7))
PANELS, CHART = "#panels canvas", "#energy-chart canvas"
HOSTILE = (
    "</script><script>document.title=1</script><img src=x onerror=document.title=2> $note &lt;"
)


@pytest.fixture(scope="module")
def tracks() -> tuple[Track, Track]:
    return track_of("verner853"), track_of("rk1", 0.01)


@pytest.fixture(scope="module")
def slow_tracks(tracks: tuple[Track, Track]) -> list[Track]:
    """Runs of 100 s, which do not end during a test on a busy machine."""
    return [replace(track, t=20 * track.t) for track in tracks]


def fitted(player: Player, tracks: Sequence[Track]) -> tuple[np.ndarray, float]:
    """Scale and origin in pixels, from masses at four times, and the largest deviation.

    The scale of the page is not known: one scale and one origin must fit all masses on
    all canvases, with x to the right and y up.
    """
    rows: list[tuple[float, float, float]] = []
    pixels: list[float] = []
    width = player.find("#time-slider").rect["width"]
    for part in (0.05, 0.31, 0.62, 0.9):
        player.drag("#time-slider", 0.5 * width, part * width)
        assert player.time == pytest.approx(part * 5, abs=0.3)
        for number, track in enumerate(tracks):
            for mass, colour in zip(track.positions, BOBS, strict=True):
                x, y = (np.interp(player.time, track.t, axis) for axis in mass)
                rows += [(x, 1, 0), (-y, 0, 1)]
                where = np.nonzero((player.pixels(PANELS, number) == colour).all(-1))
                assert len(where[0]) > 30, "the colour is not there"
                pixels += [float(np.median(axis)) for axis in where[::-1]]
    fit = np.linalg.lstsq(np.array(rows), np.array(pixels), rcond=None)[0]
    return fit, float(np.abs(rows @ fit - pixels).max())


@pytest.mark.parametrize(("width", "density"), [(1280, 1), (390, 3)])
def test_masses_are_at_their_positions_on_any_screen(
    width: int, density: int, player: Player, tracks: tuple[Track, Track]
) -> None:
    player.open(tracks, size=(width, 800), density=density)
    (scale, *pivot), off = fitted(player, tracks)
    assert off < density
    assert scale > 35 * density
    column, row = np.round(pivot).astype(int)
    for number in range(2):
        assert (player.pixels(PANELS, number)[row, column] == ROD).all()


def mutated(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, old: str, new: str) -> None:
    """Plant a mistake in one of the sources of the player."""
    sources = Path(shutil.copytree(player_page.SOURCES, tmp_path / "sources"))
    text = (sources / name).read_text(encoding="utf-8")
    assert text.count(old) == 1
    (sources / name).write_text(text.replace(old, new), encoding="utf-8")
    monkeypatch.setattr(player_page, "SOURCES", sources)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("panel.js", "this.middle[1] - this.scale", "this.middle[1] + this.scale"),
        ("panel.js", "this.scale * (x -", "1.1 * this.scale * (x -"),
        ("motion.js", "(time - t[k]) / (t[k + 1] - t[k])", "1"),
    ],
)
def test_a_mass_at_a_wrong_position_is_noticed(
    name: str,
    old: str,
    new: str,
    player: Player,
    tracks: tuple[Track, Track],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    mutated(monkeypatch, tmp_path, name, old, new)
    player.open(tracks)
    assert fitted(player, tracks)[1] > 2


def pace(player: Player) -> float:
    """Seconds of motion per second, from the start, between two frames of the browser."""
    first, last = player.driver.execute_async_script("""
        const [done, frames] = [arguments[0], []];
        const look = (now) => {
          frames.push([now / 1000, Number(document.documentElement.dataset.time)]);
          const start = frames[3]; // by then the clock runs
          if (frames.length > 8 && now / 1000 > start[0] + 0.5) done([start, frames.at(-1)]);
          else requestAnimationFrame(look);
        };
        document.getElementById("play").click();
        requestAnimationFrame(look);
    """)
    return (last[1] - first[1]) / (last[0] - first[0])


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("speed", [0.25, 1, 4])
def test_it_plays_at_the_selected_speed(
    speed: float, player: Player, slow_tracks: list[Track]
) -> None:
    player.open(slow_tracks)
    player.click(f"#speed [value='{speed}']")
    assert pace(player) == pytest.approx(speed, rel=0.2)


@pytest.mark.parametrize(
    ("end", "speed", "text"),
    [(1e-3, "0.001", "0.000000 s of 0.001 s"), (0.03, "0.01", "0.00000 s of 0.03 s"),
     (5, "1", "0.000 s of 5 s")],
)  # fmt: skip
def test_short_motions_play_slowly(end: float, speed: str, text: str, player: Player) -> None:
    player.open([at_rest(end=end)])
    assert player.find("#speed").get_attribute("value") == speed
    assert player.find("#time").text == text


def test_a_clock_of_twice_the_speed_is_noticed(
    player: Player, slow_tracks: list[Track], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mutated(monkeypatch, tmp_path, "player.js", "/ 1000", "/ 500")
    player.open(slow_tracks)
    assert pace(player) == pytest.approx(2, rel=0.2)


def test_it_plays_at_once_and_can_be_paused(player: Player, slow_tracks: list[Track]) -> None:
    player.open(slow_tracks, playing=True)
    assert player.playing
    assert 0 < player.time < 100
    player.click("#play")
    assert not player.playing
    assert player.find("#play").text == "Play"
    held, image = player.time, player.pixels(PANELS)
    assert player.find("#time").text == f"{held:.3f} s of 100 s"
    player.driver.execute_async_script("setTimeout(arguments[0], 200)")
    assert player.time == held
    assert (player.pixels(PANELS) == image).all()


def test_it_is_paused_for_readers_who_prefer_reduced_motion(
    player: Player, tracks: tuple[Track, Track]
) -> None:
    player.open(tracks)
    assert (player.playing, player.time) == (False, 0)


def test_it_stops_at_the_end_and_starts_again(player: Player) -> None:
    player.open([at_rest(end=1)])
    player.click("#speed [value='4']")
    player.click("#play")
    player.driver.execute_async_script("""
        const look = () => document.documentElement.dataset.playing === "false"
          ? arguments[0]() : requestAnimationFrame(look);
        requestAnimationFrame(look);
    """)
    assert player.time == 1
    player.click("#speed [value='0.1']")
    player.click("#play")
    assert player.playing
    assert player.time < 1


def test_the_keyboard_plays_pauses_and_steps(player: Player, slow_tracks: list[Track]) -> None:
    right, left, tab = "\ue014", "\ue012", "\ue004"
    player.open(slow_tracks)
    player.press(right * 3 + left)
    assert player.time == pytest.approx(0.04)
    player.press(left * 3)
    assert player.time == 0
    player.press(" ")
    assert player.playing
    player.press(" ")
    assert not player.playing
    held = player.time
    player.press(tab)
    assert player.js("document.activeElement.id") == "play"
    player.press(" ")
    assert player.playing
    player.press(right)
    assert not player.playing
    assert player.time > held
    held = player.time
    player.press(tab + right)
    assert player.js("document.activeElement.id") == "time-slider"
    assert player.time == pytest.approx(held + 0.02)


@pytest.mark.parametrize("kind", ["mouse", "touch"])
def test_the_energy_chart_has_a_logarithmic_scale_and_selects_any_time(
    kind: str, player: Player
) -> None:
    jump = np.where(np.linspace(0, 5, 501) < 3.7, 1e-8, 1e-2)
    player.open([at_rest(error=jump), at_rest(error=-1e-5)])
    first, second = ((player.pixels(CHART) == colour).all(-1) for colour in AFTER_ONE)
    low, high = (np.median(np.nonzero(part)[0]) for part in (first[:, 100:600], first[:, 1000:]))
    assert np.median(np.nonzero(second)[0]) == pytest.approx((low + high) / 2, abs=1)
    assert low - high > 30
    column = np.argmax(first.sum(0))  # that of the jump
    player.drag(CHART, 200, column + 4, kind)
    assert player.time == pytest.approx(3.7, abs=0.03)
    left = player.js("document.getElementById('cursor').getBoundingClientRect().x")
    assert left + 1 == pytest.approx(column + 4 + player.find(CHART).rect["x"], abs=1)
    assert player.texts("#legend li") == ["at rest: 1.0 × 10⁻²", "at rest: 1.0 × 10⁻⁵"]


def test_a_motion_may_start_at_any_time(player: Player) -> None:
    player.open([replace(at_rest(), t=10 + at_rest().t)])
    assert player.time == 10
    middle = 44 + (player.find(CHART).rect["width"] - 44 - 14) / 2  # between the margins
    player.drag(CHART, 100, middle)
    assert player.time == pytest.approx(12.5, abs=0.02)


def test_the_energy_chart_ends_at_the_powers_of_ten_around_all_errors(player: Player) -> None:
    player.open([at_rest(error=3e-5), at_rest(error=2e-9)])
    image = player.pixels(CHART)
    first, second = (np.median(np.nonzero((image == c).all(-1))[0]) for c in AFTER_ONE)
    decade = (len(image) - 8 - 36) / 5  # from 1e-9 to 1e-4, between the margins
    assert first - 8 == pytest.approx(np.log10(1e-4 / 3e-5) * decade, abs=1.5)
    assert second - first == pytest.approx(np.log10(3e-5 / 2e-9) * decade, abs=1.5)


def test_marks_are_round_and_paths_end_at_their_times(player: Player) -> None:
    t = np.linspace(0, 5, 6)
    player.open([Track("across", t, np.array([[t, 0 * t]]), (), t, UNIT)])
    sources = "".join(
        (player_page.SOURCES / name).read_text()
        for name in player_page.SCRIPTS[: player_page.SCRIPTS.index("panel.js") + 1]
    )
    spacings, marks, path, ranges, corners = player.driver.execute_script(f"""{sources}
        const view = new View(boundingBox(), 400, 300);
        return [[0.02, 0.021, 0.3, 0.5, 6, 10].map(roundSpacing),
          ticks(-0.31, 0.4, 0.2).map(({{ text }}) => text), pathOf(tracks[0], 0, 1.5, 3.25),
          view.visibleRanges(), [[view.left, view.bottom], [view.right, view.top]]
          .map(([x, y]) => [(x - view.middle[0]) / view.scale + 2.5,
            (view.middle[1] - y) / view.scale])]""")
    assert spacings == pytest.approx([0.02, 0.05, 0.5, 0.5, 10, 10])
    assert marks == ["−0.2", "0.0", "0.2", "0.4"]
    assert path == [[1.5, 0], [2, 0], [3, 0], [3.25, 0]]
    assert np.array(ranges) == pytest.approx(np.transpose(corners))  # marks stay in the frame


def test_each_run_has_its_canvas_and_its_entry_in_the_legend(
    player: Player, tracks: tuple[Track, Track]
) -> None:
    for count in (1, 2):
        player.open(tracks[:count])
        assert player.texts("figcaption") == ["verner853", "rk1"][:count]
        assert player.js(f"document.querySelectorAll('{PANELS}').length") == count
        assert player.texts("#legend li") == ["verner853: 0", "rk1: 0"][:count]
        for colour in AFTER_TWO[:count]:
            assert (player.pixels(CHART) == colour).all(-1).sum() > 100


def test_traces_fade_over_two_seconds(player: Player) -> None:
    t = np.linspace(0, 5, 301)
    across = Track("across", t, np.array([[t, 0 * t - 0.55]]), (), t, UNIT)
    player.open([across])
    player.find("#time-slider").send_keys("\ue010")  # the key End
    player.settle()
    image = player.pixels(PANELS)
    row, column = (np.median(axis) for axis in np.nonzero((image == BOBS[0]).all(-1)))
    pivot = np.median(np.nonzero((image == ROD).all(-1))[1])
    metre = (column - pivot) / 5  # and a second
    # red, of which a blue trace takes away; beside the grid's lines
    reds = [image[round(row), round(pivot + metre * x), 0] for x in (2.6, 3.2, 3.6, 4.2, 4.7)]
    assert reds[0] == 255
    assert sorted(set(reds), reverse=True) == reds


def test_it_shows_the_distance_of_the_last_masses(
    player: Player, tracks: tuple[Track, Track]
) -> None:
    player.open([at_rest((0.3, -1.0)), at_rest((0.0, -0.6))])
    assert player.find("#distance").text == "last masses 0.50000 m apart"
    player.open([at_rest((0.3, -1.0)), at_rest((0.3, -1.0)), at_rest((0.0, -0.6))])
    assert player.find("#distance").text == "last masses up to 0.50000 m apart"
    player.open([at_rest(end=5), at_rest(end=4)])
    player.find("#time-slider").send_keys("\ue010")  # the key End
    player.settle()
    assert player.find("#distance").text == "a run has ended"
    player.open(tracks)
    player.drag("#time-slider", 10, 300)
    positions = [
        [np.interp(player.time, track.t, axis) for axis in track.positions[-1]] for track in tracks
    ]
    shown = re.fullmatch(r"last masses (\d\.\d{4}) m apart", player.find("#distance").text)
    assert shown
    assert float(shown[1]) == pytest.approx(np.hypot(*np.subtract(*positions)), abs=2e-4)
    player.open(tracks[:1])
    assert not player.find("#distance").is_displayed()


def test_a_phone_shows_runs_in_a_column_with_visible_controls(
    player: Player, tracks: tuple[Track, Track]
) -> None:
    long = [replace(track, label="method_with_a_long_name " * 4 + "x" * 80) for track in tracks]
    tops = {}
    for width in (1280, 390):
        player.open(long, size=(width, 844), text="A title " * 20 + "x" * 120)
        tops[width] = player.js(
            "[...document.querySelectorAll('figure')].map((f) => f.getBoundingClientRect().top)"
        )
        assert player.js("document.documentElement.scrollWidth") <= width
        controls = player.js("document.getElementById('controls').getBoundingClientRect().bottom")
        assert controls <= 844
    assert tops[1280][0] == tops[1280][1]
    assert tops[390][1] > tops[390][0] + 300


def test_springs_and_the_dark_scheme_are_drawn(player: Player) -> None:
    images = {}
    for scheme in ("light", "dark"):
        player.open([at_rest((0, -1))], scheme=scheme)
        images[scheme] = player.pixels(PANELS)
    assert (images["light"][2, -2] == 255).all()
    assert images["dark"][2, -2].max() < 50
    player.open([replace(at_rest((0, -1)), links=(("rod", (-1, 0)),))])
    rod = player.pixels(PANELS)
    # a zigzag reaches further to the sides than a rod
    across = [np.ptp(np.nonzero((view == ROD).all(-1))[1]) for view in (images["light"], rod)]
    assert across[0] > across[1] + 6


def test_the_view_of_a_motion_in_space_turns_by_keys_and_pointer(player: Player) -> None:
    t = np.linspace(0, 5, 6)
    corner = np.tile(np.reshape([1.0, 0.0, 0.0], (1, 3, 1)), 6)
    side = np.roll(corner[0], 1, axis=0)
    links = (("thread", (1, 2, 3)),)  # so that the origin is in the middle
    player.open([Track("still", t, corner, links, t, UNIT, np.stack([-corner[0], side, -side]))])

    def angles() -> np.ndarray:
        return np.array([float(player.js(f"document.documentElement.dataset.{name}"))
                         for name in ("azimuth", "elevation")])  # fmt: skip

    def bob() -> np.ndarray:
        """Place of the mass from the pivot, up and to the right."""
        image = player.pixels(PANELS)
        place = np.median(np.nonzero((image == BOBS[0]).all(-1)), axis=1)
        return (place - middle) * [-1, 1]

    player.js("document.querySelector('#panels canvas').focus()")
    player.press("\ue014" * 5 + "\ue015" * 2)  # arrows to the right and down
    assert player.time == 0
    assert angles() == pytest.approx([0.0, 0.25])
    image = player.pixels(PANELS)
    middle = np.array([(image.shape[0] - 36 + 24) / 2, (image.shape[1] + 44 - 14) / 2])
    radius = bob()
    assert radius[0] == pytest.approx(0, abs=1)
    assert radius[1] > 40
    player.press("\ue012" * 5)
    # by -0.5 about the vertical: cos to the right, sin towards the reader
    row, column = bob()
    assert column == pytest.approx(np.cos(0.5) * radius[1], abs=1.5)
    assert row == pytest.approx(-np.sin(0.5) * np.sin(0.25) * radius[1], abs=1.5)
    player.drag(PANELS, 300, 340)
    assert angles() == pytest.approx([0.1, 0.25])
    player.press("\ue013" * 20)  # upwards, no further than the zenith
    assert angles()[1] == pytest.approx(np.pi / 2)
    assert player.find("#turning").is_displayed()
    player.open([at_rest()])
    assert not player.find("#turning").is_displayed()


@pytest.mark.parametrize("axes", [2, 3])
def test_the_view_follows_a_system_that_goes_far(axes: int, player: Player) -> None:
    t = np.linspace(0, 5, 51)
    rear = np.stack([8 * t, *(0 * t for _ in range(axes - 1))])
    front = rear + np.eye(axes)[:, :1]  # 1 m further, of a path of 41 m
    links = (("rod", (0, 1)),)
    wheels = Track("ride", t, np.stack([rear, front]), links, t, UNIT, np.stack([rear]))
    player.open([wheels])

    def apart() -> float:
        """Pixels from one mass to the other, which are beside the middle."""
        image = player.pixels(PANELS)
        places = [np.median(np.nonzero((image == bob).all(-1)), axis=1) for bob in BOBS]
        off = np.mean(places, axis=0) - [(image.shape[0] - 12) / 2, (image.shape[1] + 30) / 2]
        assert np.abs(off).max() < 2
        return float(np.linalg.norm(places[1] - places[0]))

    width = player.find("#time-slider").rect["width"]
    for part in (0.1, 0.8):
        player.drag("#time-slider", 0.5 * width, part * width)
        assert apart() > 60
    assert player.find("#follow").is_displayed()
    player.click("#follow")
    image = player.pixels(PANELS)
    places = [np.nonzero((image == bob).all(-1))[1] for bob in BOBS]
    assert all(places[1].max() - place.min() < 40 for place in places)  # they overlap
    player.open([track_of("verner853")])
    assert not player.find("#follow").is_displayed()


def test_coordinates_are_shown_over_time_and_in_the_phase_plane(player: Player) -> None:
    t = np.linspace(0, 5, 501)
    swing = CoordinateTrack("θ₁", "rad", np.cos(t), -np.sin(t))
    slide = CoordinateTrack("x", "m", 3 * t, 0 * t + 3)
    player.open([replace(at_rest(), coordinates=(swing, slide))])
    chart, plane = "#over-time", "#phase-plane"
    places = {}
    for time in (0.5, 4.0):
        player.js(f"document.getElementById('time-slider').value = {time}")
        player.js("document.getElementById('time-slider').dispatchEvent(new Event('input'))")
        player.settle()
        for selector in (chart, plane):
            dot, canvas = (player.find(f"{selector} {part}").rect for part in (".dot", "canvas"))
            across, down = (dot[a] + 5 - canvas[a] for a in "xy")
            places[selector, time] = across, down
            # on the curve, in the colour of the run
            row, column = round(down), round(across)
            near = player.pixels(f"{selector} canvas")[row - 2 : row + 3, column - 2 : column + 3]
            assert (near == AFTER_ONE[0]).all(-1).any()
    assert player.find(f"{chart} canvas").get_attribute("aria-label") == "θ₁ over time"
    player.click("#coordinate option:nth-child(2)")
    label = player.find(f"{plane} canvas").get_attribute("aria-label")
    assert label == "Rate of change of x over x"
    up = player.find(f"{chart} .dot").rect["y"] - player.find(f"{chart} canvas").rect["y"]
    assert up != pytest.approx(places[chart, 4.0][1], abs=5)
    player.open([at_rest()])
    assert not player.find("#state").is_displayed()


def test_text_is_shown_and_never_executed(player: Player) -> None:
    player.open([replace(at_rest(), label=HOSTILE)], text=HOSTILE)
    assert player.driver.title == HOSTILE
    for selector in ("h1", "#note", "figcaption"):
        assert player.find(selector).text == HOSTILE
    assert not player.driver.find_elements("css selector", "img")
    assert len(player.driver.find_elements("css selector", "script")) == 2


def test_unescaped_text_is_noticed_and_still_not_executed(
    player: Player, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(player_page, "escape", lambda text: text)
    player.open([at_rest()], text="<img src=x onerror=document.title=2>")
    assert player.driver.find_elements("css selector", "img")
    assert player.driver.title != "2"
    assert "Content Security Policy" in str(player.driver.get_log("browser"))


@pytest.fixture
def served() -> Iterator[tuple[str, dict[str, bytes], list[str]]]:
    """Address, pages and requests of a server."""
    pages: dict[str, bytes] = {}
    requests: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            requests.append(self.path)
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(pages.get(self.path, b""))

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}", pages, requests
        server.shutdown()
        thread.join()


@pytest.mark.parametrize("has_policy", [True, False])
def test_it_sends_no_requests_and_the_policy_blocks_them(
    has_policy: bool, player: Player, served: tuple[str, dict[str, bytes], list[str]]
) -> None:
    player.open([at_rest()])
    assert player.js("performance.getEntriesByType('resource').length") == 0
    text = player.path.read_text(encoding="utf-8")
    address, pages, requests = served
    pages["/page"] = (text if has_policy else re.sub("<meta http-equiv.*", "", text)).encode()
    player.driver.get(f"{address}/page")
    player.settle()
    assert requests == ["/page"]
    assert player.driver.get_log("browser") == []
    player.driver.execute_async_script("fetch('/spy').catch(() => 0).then(arguments[0])")
    assert ("/spy" in requests) is not has_policy
    assert bool(player.driver.get_log("browser")) is has_policy
