"""A page in a real browser, and tracks for it."""

from base64 import b64decode
from collections.abc import Sequence
from io import BytesIO
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import generated.double_pendulum as dp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.player.player_page import Page
from solvers.player.track import Track

#: What energy errors of the tracks are relative to.
UNIT = "energy at the start"


def track_of(method: str, h: float | None = None) -> Track:
    with ignore_predictability():
        motion = integrate(
            dp,
            (0, 5),
            (pi / 2, pi, 0, 0),
            dp.DEFAULTS,
            method=method,
            h=h,
            t_eval=np.linspace(0, 5, 301),
            energy=True,
        )
    assert motion.energy is not None
    positions = np.asarray(dp.positions_many(0.0, motion.y, dp.DEFAULTS))
    return Track(
        method,
        motion.t,
        positions,
        (("rod", (-1, 0)), ("rod", (0, 1))),
        motion.energy / motion.energy[0] - 1,
        UNIT,
    )


def at_rest(
    position: tuple[float, float] = (0.3, -1.0), error: Any = 1e-9, end: float = 5
) -> Track:
    n = 501
    positions = np.tile(np.reshape(position, (1, 2, 1)), n)
    return Track(
        "at rest",
        np.linspace(0, end, n),
        positions,
        (("spring", (-1, 0)),),
        np.full(n, error),
        UNIT,
    )


class Player:
    """A page in a browser, with the actions of a reader."""

    def __init__(self, driver: Any, path: Path) -> None:
        self.driver, self.path = driver, path

    def open(
        self,
        tracks: Sequence[Track],
        *,
        text: str = "",
        size: tuple[int, int] = (1280, 800),
        density: int = 1,
        playing: bool = False,
        scheme: str = "light",
    ) -> None:
        Page(text, text, tracks).write(self.path)
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": size[0], "height": size[1], "deviceScaleFactor": density, "mobile": False},
        )
        motion = "no-preference" if playing else "reduce"
        self.driver.execute_cdp_cmd(
            "Emulation.setEmulatedMedia",
            {
                "features": [
                    {"name": "prefers-reduced-motion", "value": motion},
                    {"name": "prefers-color-scheme", "value": scheme},
                ]
            },
        )
        self.driver.get(self.path.as_uri())
        self.settle()

    def settle(self) -> None:
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))"
        )

    def js(self, expression: str) -> Any:
        return self.driver.execute_script(f"return {expression}")

    def find(self, selector: str) -> Any:
        return self.driver.find_element("css selector", selector)

    def texts(self, selector: str) -> list[str]:
        return [found.text for found in self.driver.find_elements("css selector", selector)]

    @property
    def time(self) -> float:
        return float(self.js("document.documentElement.dataset.time"))

    @property
    def playing(self) -> bool:
        return {"true": True, "false": False}[self.js("document.documentElement.dataset.playing")]

    def click(self, selector: str) -> None:
        self.find(selector).click()
        self.settle()

    def press(self, keys: str) -> None:
        from selenium.webdriver import ActionChains

        ActionChains(self.driver).send_keys(keys).perform()
        self.settle()

    def drag(self, selector: str, start: float, end: float, kind: str = "mouse") -> None:
        """From one pixel column of an element to another one, on the way past its middle."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder
        from selenium.webdriver.common.actions.pointer_input import PointerInput

        element = self.find(selector)
        middle = int(element.rect["width"] // 2)  # the driver counts from there
        actions = ActionBuilder(self.driver, mouse=PointerInput(kind, kind), duration=20)
        pointer = actions.pointer_action
        pointer.move_to(element, round(start) - middle, 0).pointer_down()
        pointer.move_to(element, 0, 0).move_to(element, round(end) - middle, 0).pointer_up()
        actions.perform()
        self.settle()

    def pixels(self, selector: str, number: int = 0) -> np.ndarray:
        """Colours of a canvas, of shape (rows, columns, 3)."""
        url = self.js(f"document.querySelectorAll('{selector}')[{number}].toDataURL()")
        return np.asarray(Image.open(BytesIO(b64decode(url.partition(",")[2]))).convert("RGB"))
