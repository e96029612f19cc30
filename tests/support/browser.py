"""A real browser, in which pages are opened; tests without one are skipped."""

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from selenium import webdriver

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
needs_browser = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="no Chromium here; apt install chromium chromium-driver"
)


@contextmanager
def started() -> Iterator[webdriver.Chrome]:
    """A browser that logs what it asks for, and what it complains of."""
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in ("--headless", "--no-sandbox", "--disable-gpu"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    with webdriver.Chrome(options, webdriver.ChromeService(DRIVER)) as driver:
        yield driver


def opened(browser, path, width=1000, dark=False):
    """Requests beside the page and data, and complaints, of a page so many pixels wide."""
    size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    for kind in ("browser", "performance"):
        browser.get_log(kind)  # of the page before
    browser.get(path.as_uri())
    events = [json.loads(event["message"])["message"] for event in browser.get_log("performance")]
    requests = [e["params"]["request"]["url"] for e in events
                if e["method"] == "Network.requestWillBeSent"]  # fmt: skip
    others = [url for url in requests if url != path.as_uri() and not url.startswith("data:")]
    return others, browser.get_log("browser")


def ask(browser, expression):
    """The value of an expression of JavaScript in the page."""
    return browser.execute_script(f"return {expression.strip()}")
