#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly view: what it refuses, what it serves and what not, and that nothing a client sends or does not send ends it,
makes it large, or keeps others waiting.

usage: view_test.py GATEFLY ROOT"""
import http.client
import json
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

GATEFLY, ROOT = sys.argv[1], sys.argv[2]
SUMMARY = {"seed": 7, "finished": True, "gates_passed": 2, "gates_total": 2, "race_time_s": 20.0, "mean_speed_mps": 1.5,
           "crash": None, "stop_reason": "finished", "abort_reason": "", "estimation_rmse_m": [0.1, 0.1, 0.0]}
CAMPAIGN = {"arguments": {"track": "oval", "vision": "ideal", "first_seed": 7, "runs": 2, "shard": [1, 1]},
            "fly": "gatefly fly oval --seed {seed}", "result": None}


class Viewing:
    """The program while it shows a folder."""

    def __init__(self, folder, *flags):
        self.process = subprocess.Popen([GATEFLY, "view", str(folder), *flags], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        self.port = int(self.url.rstrip("/").rsplit(":", 1)[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end(signal.SIGKILL)

    def end(self, how):
        if self.process.poll() is None:
            self.process.send_signal(how)
        code = self.process.wait(timeout=20)
        self.process.stdout.close()
        self.process.stderr.close()
        return code

    def ask(self, path, method="GET", headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        connection.putrequest(method, path, skip_host=headers is not None and "Host" in headers)
        for name, value in (headers or {}).items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer.status, body, dict(answer.getheaders())

    def connection(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=10)

    def send(self, data):
        """Raw bytes; the status that comes back, None when there is none."""
        with self.connection() as raw:
            try:
                raw.sendall(data)
            except OSError:  # it has heard enough
                pass
            try:
                raw.shutdown(socket.SHUT_WR)
                answer = raw.recv(1024)
            except OSError:
                return None
            return int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else None

    def peak_megabytes(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM"))) / 1024


def refused(test, path, *flags):
    run = subprocess.run([GATEFLY, "view", str(path), *flags], capture_output=True, text=True, timeout=20)
    test.assertEqual(run.returncode, 2, run.stderr)
    test.assertEqual(run.stderr.count("\n"), 1, run.stderr)
    test.assertEqual(run.stdout, "")
    return run.stderr


class ViewTest(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        self.top = pathlib.Path(self.kept.name).resolve()
        self.flights = self.top / "out"
        (self.top / "secret.txt").write_text("secret")
        self.flight("oval-7")

    def tearDown(self):
        self.kept.cleanup()

    def flight(self, name, summary=None, page="<title>the page</title>"):
        folder = self.flights / name
        folder.mkdir(parents=True)
        (folder / "summary.json").write_text(json.dumps(SUMMARY if summary is None else summary))
        if page:
            (folder / "report.html").write_text(page)
        return folder

    def test_what_is_no_flight_is_refused_in_one_line(self):
        empty = self.top / "empty"
        empty.mkdir()
        self.assertIn("holds no flight", refused(self, empty))
        self.assertIn("is not there", refused(self, self.top / "nothing"))
        self.assertIn("is no folder", refused(self, self.top / "secret.txt"))
        self.assertIn("no report.html", refused(self, self.flight("old", page="")))
        whole = json.dumps(SUMMARY)
        for name, text in (("truncated", whole[:40]), ("nothing", ""), ("foreign", '{"name": "a package"}'), ("list", "[1, 2]"), ("noise", "\x00\xff\x01")):
            broken = self.flight(name)
            (broken / "summary.json").write_text(text)
            self.assertIn("is damaged, or not a flight's", refused(self, broken))
        campaign = self.top / "campaign"
        campaign.mkdir()
        for text in ("", "{", "[]", '{"arguments": 3}', '{"arguments": {}}'):
            (campaign / "campaign.json").write_text(text)
            self.assertIn("is damaged, or not a campaign's", refused(self, campaign))

    def test_a_flight_its_folder_and_a_campaign(self):
        with Viewing(self.flights / "oval-7") as seen:
            status, body, headers = seen.ask("/")
            self.assertEqual((status, body), (200, b"<title>the page</title>"))
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(seen.ask("/summary.json")[2]["Content-Type"], "application/json")
            status, body, headers = seen.ask("/", "HEAD")
            self.assertEqual((status, body, headers["Content-Length"]), (200, b"", "23"))
        self.flight("older", page="")
        (self.flight("hurt") / "summary.json").write_text("{")
        with Viewing(self.flights) as seen:
            body = seen.ask("/")[1].decode()
            for text in ("oval-7/report.html", "flown by an older gatefly", "summary.json is damaged"):
                self.assertIn(text, body)
            self.assertEqual(seen.ask("/oval-7")[2]["Location"], "/oval-7/")
            self.assertEqual(seen.ask("/oval-7/")[1], b"<title>the page</title>")  # no body: nowhere to put the way back
        campaign = self.top / "days"
        campaign.mkdir()
        (campaign / "campaign.json").write_text(json.dumps(CAMPAIGN))
        (campaign / "run_000007.json").write_text(json.dumps(SUMMARY))
        (campaign / "run_000008.json").write_text("{")
        with Viewing(campaign) as seen:
            body = seen.ask("/")[1].decode()
            self.assertIn(f"gatefly fly oval --seed 7 --out {campaign}/oval-7", body)
            self.assertIn("run_000008.json is damaged", body)
            self.assertNotIn("oval-7/report.html", body)
            (self.flights / "oval-7").rename(campaign / "oval-7")
            self.assertIn("oval-7/report.html", seen.ask("/")[1].decode())

    def test_the_index_counts_what_there_is_and_links_it(self):
        replay = {"kind": "replay", "flight": "oval-7", "track": "oval", "gates_passed": 2, "gates_total": 2}
        self.flight("replayed", replay)
        self.flight("lost", {**SUMMARY, "finished": False, "stop_reason": "crash", "crash": {"object": "gate 2", "t_s": 3.0}})
        evil = '"><img src=x onerror=alert(1)>'
        self.flight(evil, {**SUMMARY, "track": "<script>alert(2)</script>"})
        (self.flights / "oval-7" / "flight.mp4").write_bytes(bytes(1000))
        campaign = self.flights / "days"
        campaign.mkdir()
        (campaign / "campaign.json").write_text(json.dumps({**CAMPAIGN, "result": {"runs": 4, "finished": 3}}))
        (campaign / "report.html").write_text("old")
        with Viewing(self.flights) as seen:
            body = seen.ask("/")[1].decode()
            for text in ("<h1>3 flights, 2 finished; 1 replay; 1 campaign</h1>", 'href="oval-7/report.html"', 'href="oval-7/flight.mp4"', 'href="days/"',
                         "3 of 4 races finished", "crashed into gate 2", "flown again by its sensors", "&quot;&gt;&lt;img src=x"):
                self.assertIn(text, body)
            for text in ("<img", "<script>alert"):
                self.assertNotIn(text, body)
            self.assertIn('id="list"', seen.ask("/days/")[1].decode())  # made anew, whatever report.html there is

    def test_every_page_leads_back_to_the_index_and_the_files_stay_as_they_are(self):
        page = "<!doctype html>\n<html><body class='x'><p>a flight</p></body></html>"
        folder = self.flight("whole", page=page)
        campaign = self.flights / "days"
        campaign.mkdir()
        (campaign / "campaign.json").write_text(json.dumps(CAMPAIGN))
        self.flight("days/oval-7", page=page)
        with Viewing(self.flights) as seen:
            for path, where in (("/whole/", "all flights"), ("/whole/report.html", "all flights"), ("/days/", "all flights"),
                                ("/days/oval-7/report.html", "the campaign")):
                status, body, headers = seen.ask(path)
                self.assertIn(f'<a href="../" style="color:inherit">← {where}</a>', body.decode(), path)
                self.assertEqual(seen.ask(path, "HEAD")[2]["Content-Length"], str(len(body)))
        with Viewing(folder) as seen:  # nothing is above it
            self.assertEqual(seen.ask("/")[1].decode(), page)
        self.assertEqual((folder / "report.html").read_text(), page)

    def test_a_part_of_a_film(self):
        film = bytes(range(256)) * 1000
        (self.flights / "oval-7" / "flight.mp4").write_bytes(film)
        with Viewing(self.flights) as seen:
            def part(asked):
                status, body, headers = seen.ask("/oval-7/flight.mp4", headers={"Range": asked})
                return status, body, headers.get("Content-Range")
            self.assertEqual(seen.ask("/oval-7/flight.mp4")[1], film)
            self.assertEqual(part("bytes=10-19"), (206, film[10:20], "bytes 10-19/256000"))
            self.assertEqual(part("bytes=255990-"), (206, film[-10:], "bytes 255990-255999/256000"))
            self.assertEqual(part("bytes=-5"), (206, film[-5:], "bytes 255995-255999/256000"))
            self.assertEqual(part("bytes=0-999999999999"), (206, film, "bytes 0-255999/256000"))
            self.assertEqual(part("bytes=256000-"), (416, b"not so long\n", "bytes */256000"))
            self.assertEqual(part("bytes=0-1,5-6"), (200, film, None))

    def test_every_answer_says_what_its_page_may_do(self):
        self.flight("whole", page="<body>")
        with Viewing(self.flights) as seen:
            for path, method, headers, wanted in (
                    ("/", "GET", None, "script-src 'unsafe-inline'"), ("/whole/", "GET", None, "sandbox allow-scripts"), ("/whole/summary.json", "GET", None, "sandbox"),
                    ("/whole", "GET", None, "sandbox"), ("/nothing", "GET", None, "sandbox"), ("/", "POST", None, "sandbox"),
                    ("/", "GET", {"Host": "evil.example"}, "sandbox"), ("/", "HEAD", None, "script-src")):
                policy = seen.ask(path, method, headers)[2]["Content-Security-Policy"]
                self.assertTrue(policy.startswith("default-src 'none'; "), policy)
                self.assertIn(wanted, policy, path)
                self.assertNotIn("connect-src", policy)

    def test_nothing_outside_of_the_folder(self):
        inside = self.flights / "oval-7"
        (inside / "out").symlink_to(self.top)
        (inside / "leak.txt").symlink_to(self.top / "secret.txt")
        (inside / ".hidden").write_text("secret")
        with Viewing(inside) as seen:
            for path in ("/../secret.txt", "/../../secret.txt", "/%2e%2e/%2e%2e/secret.txt", "/..%2f..%2fsecret.txt", "/%2e%2e%2f%2e%2e%2fsecret.txt",
                         "/%252e%252e/secret.txt", "/out/secret.txt", "/leak.txt", "/.hidden", "//etc/passwd", "/etc/passwd", "/%00", "/summary.json%00.html",
                         "/..\\..\\secret.txt", "/%c0%ae%c0%ae/secret.txt", "http://127.0.0.1/../secret.txt", "/" + "../" * 2000 + "etc/passwd"):
                status, body, _ = seen.ask(path)
                self.assertGreaterEqual(status, 400, path)
                self.assertNotIn(b"secret", body, path)
                self.assertNotIn(b"root:", body, path)
            for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS"):
                self.assertEqual(seen.ask("/summary.json", method)[0], 405, method)
            self.assertEqual(seen.ask("/", headers={"Host": "evil.example"})[0], 403)
            self.assertEqual(seen.ask("/", headers={"Host": f"localhost:{seen.port}"})[0], 200)
            self.assertEqual(sorted(path.name for path in inside.iterdir()), [".hidden", "leak.txt", "out", "report.html", "summary.json"])

    def test_only_this_machine_is_answered(self):
        with Viewing(self.flights / "oval-7") as seen:
            local = bytes([127, 0, 0, 1])[::-1].hex().upper() + f":{seen.port:04X}"
            tables = [pathlib.Path(f"/proc/net/{name}") for name in ("tcp", "tcp6")]
            lines = [line.split() for table in tables if table.exists() for line in table.read_text().splitlines()]
            listening = [line[1] for line in lines if line[3] == "0A" and line[1].endswith(f":{seen.port:04X}")]
            self.assertEqual(listening, [local])

    def test_a_flood_of_bad_requests_is_survived(self):
        random.seed(1)
        with Viewing(self.flights / "oval-7") as seen:
            for _ in range(60):
                seen.send(random.randbytes(random.randrange(1, 4000)))
            for data in (b"GET / HTTP/1.1\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/1.1\nHost: 127.0.0.1\n\n", b"GET / HTTP/1.1\r\nHost : 127.0.0.1\r\n\r\n", b"\r\n" * 1000, b"GET / HTTP/9.9\r\n\r\n", b"GET " + b"a" * 200_000 + b" HTTP/1.1\r\n\r\n",
                         b"GET / HTTP/1.1\r\nHost: " + b"x" * 1_000_000 + b"\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 20_000 + b"\r\n",
                         b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 99999999999999999999\r\n\r\n",
                         b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n",
                         b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes=0-99999999999999,5-1,a-b\r\n\r\n"):
                seen.send(data)
            self.assertEqual(seen.ask("/")[0], 200)
            self.assertIsNone(seen.process.poll())

    def test_what_is_too_long_is_refused_and_takes_no_memory(self):
        host, megabyte = b"Host: 127.0.0.1\r\n", b"x" * 1_000_000
        with Viewing(self.flights / "oval-7") as seen:
            before = seen.peak_megabytes()
            for data, wanted in ((b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\n" + host + b"\r\n", 414), (b"GET / HTTP/1.1\r\n" + host + b"A: " + b"b" * 9000, 431),
                                 (b"GET / HTTP/1.1\r\n" + host + b"A: b\r\n" * 3000, 431), (b"POST / HTTP/1.1\r\n" + host + b"\r\n", 405),
                                 (b"GET / HTTP/1.1\r\n" + host + b"Content-Length: 15000000\r\n\r\n", 413), (b"GET / HTTP/1.1\r\n" + host, 408)):
                self.assertEqual(seen.send(data), wanted, data[:40])
            for start in (b"GET /", b"GET / HTTP/1.1\r\nA: ", b"GET / HTTP/1.1\r\n" + host + b"Content-Length: 15000000\r\n\r\n", b""):
                self.assertIn(seen.send(start + 15 * megabyte), (None, 413, 414, 431))  # None: it no longer listens
            self.assertEqual(seen.ask("/")[0], 200)
            self.assertLess(seen.peak_megabytes() - before, 16)

    def test_who_is_slow_keeps_nobody_waiting_and_is_not_waited_for(self):
        with Viewing(self.flights / "oval-7") as seen:
            threads = len(list(pathlib.Path(f"/proc/{seen.process.pid}/task").iterdir()))
            silent = [seen.connection() for _ in range(100)]
            slow = [seen.connection() for _ in range(20)]
            began = time.monotonic()
            for letter in b"GET / HTT":  # a letter at a time does not buy time
                for raw in slow:
                    try:
                        raw.send(bytes([letter]))
                    except OSError:
                        pass
                asked = time.monotonic()
                self.assertEqual(seen.ask("/")[0], 200)
                self.assertLess(time.monotonic() - asked, 2)
                time.sleep(0.1)
            self.assertLessEqual(len(list(pathlib.Path(f"/proc/{seen.process.pid}/task").iterdir())), threads + 34)
            slow[-1].settimeout(20)
            self.assertIn(slow[-1].recv(100)[:12], (b"HTTP/1.1 408", b""))
            self.assertLess(time.monotonic() - began, 15)
            for raw in silent + slow:
                raw.close()

    def test_who_says_nothing_is_hung_up_on(self):
        with Viewing(self.flights / "oval-7") as seen:
            for says_so in (True, False):
                with seen.connection() as raw:
                    if says_so:
                        raw.shutdown(socket.SHUT_WR)
                    self.assertEqual(raw.recv(10), b"")

    def test_who_does_not_read_keeps_nobody_waiting(self):
        (self.flights / "oval-7" / "flight.mp4").write_bytes(bytes(30_000_000))
        with Viewing(self.flights / "oval-7") as seen:
            readers = [seen.connection() for _ in range(40)]
            for raw in readers:
                raw.sendall(b"GET /flight.mp4 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            for _ in range(5):
                asked = time.monotonic()
                self.assertEqual(seen.ask("/")[0], 200)
                self.assertLess(time.monotonic() - asked, 2)
            self.assertLess(seen.peak_megabytes(), 200)
            for raw in readers:
                raw.close()

    def test_ctrl_c_ends_it(self):
        for how, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with Viewing(self.flights) as seen:
                self.assertEqual(seen.ask("/")[0], 200)
                self.assertEqual(seen.end(how), code)

    def test_a_port_that_is_taken(self):
        with Viewing(self.flights) as seen:
            self.assertIn("cannot be had", refused(self, self.flights, "--port", str(seen.port)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
