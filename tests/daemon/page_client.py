# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the live page use: requests, streams of events, a running jinkd."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import time
import tty

STUB = b"<!DOCTYPE html><title>stub</title>" + bytes(range(32, 127)) * 9000  # larger than what the system buffers
MAX_HEAD, MAX_CLIENTS = 8192, 8
PATIENCE = 30.0


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, what, patience=PATIENCE):
    end = time.monotonic() + patience
    while not (found := condition()):
        assert time.monotonic() < end, what
        time.sleep(0.02)
    return found


def connect(port, receive_buffer=None, address="127.0.0.1"):
    client = socket.socket()
    if receive_buffer:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    client.settimeout(PATIENCE)
    client.connect((address, port))
    return client


def read_all(client):
    data = b""
    try:
        while part := client.recv(1 << 16):
            data += part
    except ConnectionResetError:
        pass
    return data


def get(target, host="localhost"):
    return f"GET {target} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()


def answer(port, request, address="127.0.0.1"):
    """(status, fields, body) of one request; status 0: closed without an answer."""
    with connect(port, address=address) as client:
        try:
            client.sendall(request)
        except (ConnectionResetError, BrokenPipeError):
            pass  # refused before all of it was sent; what was answered may still be read
        data = read_all(client)
    if not data:
        return 0, {}, b""
    head, _, body = data.partition(b"\r\n\r\n")
    lines = head.decode().split("\r\n")
    return int(lines[0].split()[1]), {k.lower(): v.strip() for k, _, v in (line.partition(":") for line in lines[1:])}, body


def strict(text):
    def refuse(constant):
        raise ValueError(f"{constant} is no JSON")
    return json.loads(text, parse_constant=refuse)


class Hearer:
    """One stream of events."""

    def __init__(self, port, target="/events"):
        self.client, self.buffer = connect(port), b""
        self.client.sendall(get(target))
        while b"\r\n\r\n" not in self.buffer:
            self.fill()
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status, self.head = int(head.split()[1]), head.decode()

    def fill(self):
        part = self.client.recv(1 << 16)
        if not part:
            raise EOFError("the stream ended")
        self.buffer += part

    def next(self):
        """The next event that has data."""
        while True:
            while b"\n\n" not in self.buffer:
                self.fill()
            block, _, self.buffer = self.buffer.partition(b"\n\n")
            lines = block.decode("ascii").split("\n")
            assert all(line.startswith(("data: ", "retry: ")) for line in lines), block
            if lines[0].startswith("data: "):
                assert len(lines) == 1, block
                return strict(lines[0][6:])

    def close(self):
        self.client.close()


class Running:
    """jinkd on a pseudo-terminal on which nobody speaks."""

    def __init__(self, jinkd, folder, *options, address=""):
        self.master, self.other = os.openpty()
        tty.setraw(self.other)
        self.port, self.summary = free_port(), folder / "summary.json"
        page = folder / "stub.html"
        page.write_bytes(STUB)
        self.output = open(folder / "said", "wb")
        self.jinkd = subprocess.Popen([jinkd, "--serial", os.ttyname(self.other), "--page", (address and address + ":") + str(self.port), "--page-file", page, "--summary",
                                       self.summary, *options], stdout=self.output, stderr=subprocess.STDOUT)
        until(lambda: self.jinkd.poll() is None and socket.socket().connect_ex((address or "127.0.0.1", self.port)) == 0, "jinkd does not listen")

    def waited(self):
        """How long the loop was ready to run without a processor [s]."""
        return int(pathlib.Path(f"/proc/{self.jinkd.pid}/schedstat").read_text().split()[1]) * 1e-9

    def processor(self):
        """Processor time of all its threads [s]."""
        fields = pathlib.Path(f"/proc/{self.jinkd.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self):
        """No reader may hold a step: those that read nothing stand for seconds. How late the host lets a step begin is not judged."""
        waited = self.waited()
        self.jinkd.send_signal(signal.SIGTERM)
        assert self.jinkd.wait(PATIENCE) == 0, "jinkd did not end well"
        summary = json.loads(self.summary.read_text())
        assert summary["steps"] > 50, summary["steps"]
        assert summary["step_max_us"] * 1e-6 < 1.0 + waited, f"a step of {summary['step_max_us']} us, {waited} s without a processor"
        os.close(self.master)
        os.close(self.other)
