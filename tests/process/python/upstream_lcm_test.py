"""Upstream's LCM 1.5, as its PyPI wheel provides it, together with palpated, which publishes
by Debian's 1.3.1 and receives with its own receiver: both are compatible. Skipped without the
wheel."""

import time
import unittest

import palpate
from palpate import messages
from processes import PATIENCE, ProcessTest

try:
    import lcm
except ImportError:
    lcm = None


@unittest.skipIf(lcm is None, "no module lcm (pip install lcm)")
class UpstreamLcm(ProcessTest):
    def test_exchanges_messages_with_palpated(self) -> None:
        daemon = self.start_daemon()
        speaker, listener = lcm.LCM(self.control), lcm.LCM(self.housekeeping)
        heard = []
        listener.subscribe("HEALTH", lambda channel, data: heard.append(messages.health_t.decode(data)))
        wrench = messages.ft_wrench_t()
        wrench.session = 77
        end = time.monotonic() + PATIENCE

        def count(field: str) -> int:
            if not heard:
                return 0
            names = [palpate.text_of(name) for name in heard[-1].input_name]
            return getattr(heard[-1], field)[names.index("FT_WRENCH")] if "FT_WRENCH" in names else 0
        while count("received") < 50 and time.monotonic() < end:
            wrench.utime = int(1e6 * time.time())
            wrench.seq += 1
            speaker.publish("FT_WRENCH", wrench.encode())
            listener.handle_timeout(5)
        self.assertGreaterEqual(count("received"), 50, daemon.output())
        self.assertEqual(count("rejected"), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
