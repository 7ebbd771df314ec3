"""A page of palpate's in a real browser."""
import io
import time

import numpy as np
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

# Busy machines are late: no result of this test depends on timing.
PATIENCE = 60  # s


def wait_for(condition, what, patience=PATIENCE):
    end = time.monotonic() + patience
    while True:
        value = condition()
        if value is not None and value is not False:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"did not happen within {patience} s: {what}")
        time.sleep(0.05)


class Browser:
    """Headless; the page has `window.palpate` with `stage` and `frames`."""
    browser = None

    def open(self, url, folder, width, height):
        """`folder`: of the browser's profile."""
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for word in ("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--disable-background-networking", "--no-first-run",
                     f"--user-data-dir={folder}/profile",
                     f"--window-size={width},{height}"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.browser.set_script_timeout(PATIENCE)
        self.resize(width, height)
        self.browser.get(url)

    def resize(self, width, height):
        self.browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 760})

    def js(self, expression):
        return self.browser.execute_script(f"return {expression};")

    def click(self, selector):
        self.browser.execute_script("document.querySelector(arguments[0]).click()", selector)

    def text(self, selector):
        return self.js(f"document.querySelector({selector!r}).textContent")

    def mouse(self, kind, x, y, pressed=True):
        self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": float(x), "y": float(y), "button": "left" if pressed else "none",
            "buttons": 1 if pressed and kind != "mouseReleased" else 0, "clickCount": 1})

    def picture(self, path=None):
        """The page as pixels, height x width x 3."""
        png = self.browser.get_screenshot_as_png()
        if path:
            with open(path, "wb") as file:
                file.write(png)
        return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)

    def frames(self):
        return self.js("palpate.frames")

    def next_frames(self, count=3):
        """Waits until this many more frames were drawn."""
        before = self.frames()
        wait_for(lambda: self.frames() >= before + count, "frames are drawn")

    def project(self, points):
        """Pixels and depth of points in O, by the page's camera."""
        camera = self.js(
            "(() => { const s = palpate.stage, b = s.canvas.getBoundingClientRect(); return {"
            "p: s.camera.projectionMatrix.elements, v: s.camera.matrixWorldInverse.elements,"
            "box: [b.left, b.top, b.width, b.height]}; })()")
        P, V = (np.array(camera[k]).reshape(4, 4).T for k in "pv")
        left, top, width, height = camera["box"]
        clip = P @ V @ np.vstack([points.T, np.ones(len(points))])
        x, y, z = clip[:3] / clip[3]
        return np.column_stack([left + (x + 1) / 2 * width, top + (1 - y) / 2 * height, z])

    def errors(self):
        return [e["message"] for e in self.browser.get_log("browser") if e["level"] == "SEVERE"]

    def quit(self):
        if self.browser:
            self.browser.quit()
