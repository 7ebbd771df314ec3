"""The page of palpate-setup in a real browser, and what its server refuses.

usage: page_test.py BINARIES SOURCE [UNITTEST-OPTIONS]
"""
import http.client
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

BINARIES, SOURCE = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)

PATIENCE = 60  # s


def wait_for(condition, what):
    end = time.monotonic() + PATIENCE
    while not (value := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"did not happen within {PATIENCE} s: {what}")
        time.sleep(0.05)
    return value


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="palpate_setup_page_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.program = subprocess.Popen(["setpriv", "--pdeathsig", "TERM", BINARIES / "palpate-setup", self.folder / "cell", "--page"],
                                        stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        self.address = self.program.stdout.readline().strip()
        self.assertRegex(self.address, r"^http://127\.0\.0\.1:\d+/#token=[0-9a-f]{64}$")
        self.port = int(self.address.split(":")[2].split("/")[0])
        self.token = self.address.split("=")[1]

    def end(self):
        self.program.terminate()
        code = self.program.wait(PATIENCE)
        self.program.stdout.close()
        self.assertEqual(code, 0)

    def ask(self, method, path, body=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        self.addCleanup(connection.close)
        connection.request(method, path, None if body is None else json.dumps(body), headers)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def state(self):
        return json.loads(self.ask("GET", "/state", **{"X-Palpate-Token": self.token})[1])


class Server(Page):
    def test_refuses_what_is_not_its_own_page(self):
        token = {"X-Palpate-Token": self.token}
        self.assertEqual(self.ask("GET", "/")[0], 200)
        self.assertNotIn(self.token.encode(), self.ask("GET", "/")[1])
        self.assertEqual(self.ask("GET", "/state")[0], 401)
        self.assertEqual(self.ask("GET", "/state", **{"X-Palpate-Token": "0" * 64})[0], 401)
        self.assertEqual(self.ask("GET", "/state", Host="attacker.example", **token)[0], 403)
        self.assertEqual(self.ask("POST", "/run", {"step": "object"}, Origin="http://attacker.example", **token)[0], 403)
        self.assertEqual(self.ask("GET", "/file/../../etc/passwd", **token)[0], 404)
        self.assertEqual(self.ask("GET", "/file/setup.json", **token)[0], 404)
        self.assertEqual(self.ask("GET", "/state", **token)[0], 200)

    def test_names_wrong_requests(self):
        token = {"X-Palpate-Token": self.token}
        self.assertEqual(self.ask("POST", "/asked", {"step": "nonsense"}, **token)[0], 400)
        for body, text in (({"step": "nonsense"}, "nonsense"), ({}, "step"), ({"step": "object", "skip": 3}, "skip"), ([], "mapping")):
            status, answer = self.ask("POST", "/run", body, **token)
            self.assertEqual(status, 400, body)
            self.assertIn(text, json.loads(answer)["error"])


class Browser(Page):
    def setUp(self):
        super().setUp()
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-background-networking", "--no-first-run",
                     f"--user-data-dir={self.folder}/profile", "--window-size=1200,900"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.addCleanup(self.browser.quit)
        self.browser.get(self.address)
        wait_for(lambda: self.js("window.palpateSetup && palpateSetup.state !== null"), "the page shows the state")

    def js(self, expression, *arguments):
        return self.browser.execute_script(f"return {expression};", *arguments)

    def click(self, selector):
        self.browser.execute_script("document.querySelector(arguments[0]).click()", selector)

    def run_step(self):
        """Presses the button as soon as the page has seen that no step runs."""
        wait_for(lambda: not self.js("document.getElementById('run').disabled"), "the button is enabled")
        self.click("#run")

    def text(self, selector):
        return self.js("document.querySelector(arguments[0]).textContent", selector)

    def fill(self, **values):
        for key, value in values.items():
            self.browser.execute_script("document.querySelector(`[name=${arguments[0]}]`).value = arguments[1]", key, value)

    def choose(self, key, value):
        """As a person does, so that the page notices."""
        self.fill(**{key: value})
        self.browser.execute_script("document.querySelector(`[name=${arguments[0]}]`).dispatchEvent(new Event('input', {bubbles: true}))", key)

    def is_asked(self, key):
        return self.js("document.querySelector(`[name=${arguments[0]}]`).offsetParent !== null", key)

    def shown(self, step):
        self.click(f'[data-step="{step}"]')
        wait_for(lambda: "chosen" in self.js("document.querySelector(arguments[0]).className", f'[data-step="{step}"]'), step)

    def status(self, step):
        return next(one["status"] for one in self.state()["steps"] if one["name"] == step)

    def test_steps_are_skipped_run_and_stopped(self):
        self.assertNotIn("token", self.js("location.href"))
        self.shown("machine")
        self.click("#skip")
        wait_for(lambda: self.status("machine") == "skipped", "step machine is skipped")
        self.shown("motion")
        self.assertIn("needs wrist", self.text("#why"))
        self.assertTrue(self.js("document.getElementById('run').disabled"))

        self.shown("object")
        wait_for(lambda: self.is_asked("size") and not self.is_asked("file"), "a box has a size")
        self.choose("mesh", "file")
        wait_for(lambda: self.is_asked("file") and not self.is_asked("size"), "a file has a name")
        self.choose("mesh", "box")
        wait_for(lambda: self.is_asked("size") and not self.is_asked("file"), "a box has a size")
        self.fill(size="0.5 0.06 0.06", mass="much")
        self.run_step()
        wait_for(lambda: "mass" in self.text("#log"), "the wrong answer is named")
        self.assertEqual(self.status("object"), "open")
        self.fill(mass="0.054")
        self.run_step()
        wait_for(lambda: self.status("object") == "done", "step object is done")
        wait_for(lambda: "30 kg/m^3" in self.text("#lines"), "its result is shown")
        self.assertIn("0.054 kg, weighed", (self.folder / "cell/palpate.yaml").read_text())

        self.shown("channels")
        port = 10000 + self.port % 20000
        self.fill(lower="0 -1 0", upper="1 1 1", seconds="300", control=f"udpm://239.255.90.9:{port}?ttl=0")
        self.run_step()
        wait_for(lambda: self.state()["running"] == "channels", "step channels runs")
        wait_for(lambda: self.js("!document.getElementById('stop').hidden"), "the button is shown")
        self.click("#stop")
        wait_for(lambda: self.state()["running"] == "", "it has stopped")
        wait_for(lambda: "stopped at the page" in self.text("#log"), "the page says so")
        self.assertEqual(self.status("channels"), "failed")
        severe = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]
        self.assertEqual([line for line in severe if "favicon" not in line], [])


if __name__ == "__main__":
    unittest.main()
