# SPDX-License-Identifier: BSD-3-Clause
"""libjink.so.0 by ctypes: the parts of jink.h that a program without a CAN bus needs."""
import ctypes
import os

ABI = 0
PORT_AUTOPILOT = 0
FLAG_AUTOPILOT_HEARD, FLAG_ARMED, FLAG_OWN_STATE, FLAG_HOME, FLAG_NOMINAL_IS_LEG, FLAG_CONFLICT = 1, 2, 32, 64, 128, 512
FAULT_AUTOPILOT_SILENT = 2
OWN_SENSOR = 1
THREAT_TRACK, THREAT_OBSTACLE, THREAT_CLOSED_AREA = 1, 2, 6
STACKS = (None, "ardupilot", "px4")
CONTROLS = ("autopilot", "announcing", "requesting", "ours", "returning", "refused", "overruled")


class Options(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("clock_mhz", ctypes.c_uint32), ("system_id", ctypes.c_uint8),
                ("has_cloud", ctypes.c_uint8), ("has_can", ctypes.c_uint8), ("mavlink_over_can", ctypes.c_uint8),
                ("node_id", ctypes.c_uint8), ("reserved", ctypes.c_uint8 * 3), ("unique_id", ctypes.c_uint8 * 16)]


VECTOR = ctypes.c_float * 3


class Status(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("flags", ctypes.c_uint32), ("faults", ctypes.c_uint32),
                ("system_state", ctypes.c_int32), ("time_us", ctypes.c_int64), ("state", ctypes.c_int32),
                ("control", ctypes.c_int32), ("own_source", ctypes.c_int32), ("stack", ctypes.c_int32),
                ("flight_mode", ctypes.c_int32), ("custom_mode", ctypes.c_uint32), ("system_id", ctypes.c_uint32),
                ("home_lat", ctypes.c_int32), ("home_lon", ctypes.c_int32), ("home_alt", ctypes.c_int32),
                ("home", VECTOR), ("position", VECTOR), ("velocity", VECTOR), ("yaw", ctypes.c_float),
                ("nominal_end", VECTOR), ("nominal_speed", ctypes.c_float), ("command", VECTOR),
                ("margin", ctypes.c_float), ("plan", ctypes.c_int32), ("manoeuvre", ctypes.c_int32),
                ("method", ctypes.c_uint32), ("threat", ctypes.c_int32), ("time_to_loss", ctypes.c_float),
                ("time_to_closest", ctypes.c_float), ("conflict_margin", ctypes.c_float),
                ("miss_distance", ctypes.c_float), ("own_at_closest", VECTOR), ("threat_at_closest", VECTOR),
                ("tracks", ctypes.c_uint32), ("obstacles", ctypes.c_uint32), ("closed_areas", ctypes.c_uint32),
                ("work", ctypes.c_uint32), ("bytes_in", ctypes.c_uint32), ("bytes_out", ctypes.c_uint32),
                ("reserved", ctypes.c_uint32)]


class TrackReport(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("id", ctypes.c_uint32), ("source", ctypes.c_int32),
                ("has_velocity", ctypes.c_uint32), ("stamp_us", ctypes.c_int64), ("position", VECTOR),
                ("velocity", VECTOR), ("radius", ctypes.c_float), ("sigma_position", ctypes.c_float),
                ("sigma_velocity", ctypes.c_float), ("is_unmanned", ctypes.c_uint32)]


class RangeReport(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("sensor", ctypes.c_uint32), ("stamp_us", ctypes.c_int64),
                ("direction", VECTOR), ("range", ctypes.c_float), ("max_range", ctypes.c_float),
                ("half_angle", ctypes.c_float)]


class ClosedArea(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("has_place", ctypes.c_uint32), ("lat", ctypes.c_int32),
                ("lon", ctypes.c_int32), ("alt", ctypes.c_int32), ("centre", ctypes.c_float * 2),
                ("velocity", ctypes.c_float * 2), ("radius", ctypes.c_float), ("bottom", ctypes.c_float),
                ("top", ctypes.c_float), ("margin", ctypes.c_float), ("reserved", ctypes.c_uint32),
                ("stamp_us", ctypes.c_int64), ("ends_us", ctypes.c_int64)]


class Error(RuntimeError):
    """What jink_error_text says."""


class Coprocessor:
    """A handle. Functions of the library by their names without `jink_`; an error raises Error."""

    def __init__(self, library=None, **options):
        self._library = ctypes.CDLL(library or os.environ.get("JINK_LIBRARY", "libjink.so.0"))
        self._library.jink_error_text.restype = ctypes.c_char_p
        self._library.jink_destroy.restype = None
        self._library.jink_destroy.argtypes = [ctypes.c_void_p]
        self._handle = ctypes.c_void_p()
        chosen = Options(size=ctypes.sizeof(Options), **options)
        self._check(self._library.jink_create(ABI, ctypes.byref(chosen), ctypes.byref(self._handle)))
        self._out = (ctypes.c_uint8 * 4096)()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._library.jink_destroy(self._handle)
        self._handle = ctypes.c_void_p()

    def _check(self, result):
        if result != 0:
            raise Error(self._library.jink_error_text(result).decode())

    def set_parameter(self, name, value):
        self._check(self._library.jink_set_parameter(self._handle, name.encode(), ctypes.c_float(value)))

    def feed(self, data, port=PORT_AUTOPILOT):
        self._check(self._library.jink_feed(self._handle, port, data, ctypes.c_size_t(len(data)), None))

    def step(self, now_us):
        self._check(self._library.jink_step(self._handle, ctypes.c_int64(now_us)))

    def take(self):
        taken = ctypes.c_size_t()
        self._check(self._library.jink_take(self._handle, self._out, ctypes.c_size_t(len(self._out)), ctypes.byref(taken)))
        return bytes(self._out[: taken.value])

    def report_track(self, **fields):
        report = TrackReport(size=ctypes.sizeof(TrackReport), **fields)
        self._check(self._library.jink_report_track(self._handle, ctypes.byref(report)))

    def report_range(self, **fields):
        report = RangeReport(size=ctypes.sizeof(RangeReport), **fields)
        self._check(self._library.jink_report_range(self._handle, ctypes.byref(report)))

    def set_closed_areas(self, now_us, *areas):
        """Each area as a dictionary of its fields."""
        closed = (ClosedArea * len(areas))(*(ClosedArea(size=ctypes.sizeof(ClosedArea), **area) for area in areas))
        self._check(self._library.jink_set_closed_areas(self._handle, ctypes.c_int64(now_us), closed, ctypes.c_size_t(len(areas))))

    def status(self):
        status = Status(size=ctypes.sizeof(Status))
        self._check(self._library.jink_get_status(self._handle, ctypes.byref(status)))
        return status
