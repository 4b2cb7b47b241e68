/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The whole co-processor in a process of one's own, for C11, C++ and whatever calls C functions: libjink.so.0.
 *
 * The caller owns ports and clock: it hands in the bytes that arrive, calls jink_step() every 20 ms, and sends the
 * bytes that jink_take() gives. docs/guides/c_interface.md shows it.
 *
 * Frames: positions and velocities are in the autopilot's local frame, East, North, Up, [m] and [m/s]. Times are
 * microseconds on one monotonic clock of the caller's.
 *
 * Errors: a function that can fail returns a jink_result. Unless that is JINK_OK, the call changed nothing and wrote
 * nothing through its pointers. A null pointer, an unknown handle, a wrong size or a non-finite number is refused; no
 * exception leaves the library.
 *
 * Versions: `size` of a structure is set by the caller, to sizeof. A library of the same JINK_ABI never changes a field
 * that is here. The library refuses sizes that it does not know.
 *
 * Memory: jink_create() allocates once, less than 1.5 MiB; no other function allocates.
 *
 * Threads: one thread at a time for each handle. Different handles share nothing.
 */
#ifndef JINK_H
#define JINK_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define JINK_API __attribute__((visibility("default")))
#else
#define JINK_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Of this header; jink_create() refuses any other than the library's. */
#define JINK_ABI 0

typedef int32_t jink_result;
enum {
    JINK_OK = 0,
    JINK_ERROR_NULL = 1,          /**< a pointer that is needed is null */
    JINK_ERROR_HANDLE = 2,        /**< no handle of jink_create(), or already destroyed */
    JINK_ERROR_SIZE = 3,          /**< a structure's `size` is none that this library knows */
    JINK_ERROR_VERSION = 4,       /**< JINK_ABI of the caller is not the library's */
    JINK_ERROR_OPTION = 5,        /**< an option is out of range, or does not go with the others */
    JINK_ERROR_MEMORY = 6,        /**< no memory for a handle */
    JINK_ERROR_TOO_MANY = 7,      /**< JINK_MAX_HANDLES exist already */
    JINK_ERROR_TIME = 8,          /**< not later than the last step, negative, or above JINK_LATEST_TIME */
    JINK_ERROR_PORT = 9,          /**< no such port, or the options leave it out */
    JINK_ERROR_FULL = 10,         /**< the queue is full until the next step */
    JINK_ERROR_NAME = 11,         /**< no parameter of this name */
    JINK_ERROR_VALUE = 12,        /**< non-finite or out of range */
    JINK_ERROR_INCONSISTENT = 13, /**< each in range, but not together with the other parameters */
    JINK_ERROR_INDEX = 14,        /**< at or beyond the count */
    JINK_ERROR_ENDED = 15         /**< after jink_shut_down() */
};

#define JINK_MAX_HANDLES 64
#define JINK_LATEST_TIME INT64_C(4000000000000000) /**< [us] */
#define JINK_MAX_CLOSED_AREAS 64

/** A co-processor. */
typedef struct jink_coprocessor jink_coprocessor;

/** What jink_create() sets up. Zeros but for `size` are a co-processor on a serial line with everything by default. */
typedef struct jink_options {
    uint32_t size;
    uint32_t clock_mhz; /**< plans go on over several steps, as on a processor of this clock, 125 to 4000; 0: each in
                           one step */
    uint8_t system_id;  /**< of the autopilot; 0: the first that is heard */
    uint8_t has_cloud;  /**< 1: JINK_PORT_CLOUD brings a LiDAR's point clouds */
    uint8_t has_can;    /**< 1: a DroneCAN bus, by jink_feed_can() and jink_take_can() */
    uint8_t mavlink_over_can; /**< 1: MAVLink comes through the bus; JINK_PORT_AUTOPILOT is left out. Needs has_can. */
    uint8_t node_id;          /**< on the bus, 1 to 127; 0: one is requested */
    uint8_t reserved[3];      /**< 0 */
    uint8_t unique_id[16];    /**< of the node */
} jink_options;

JINK_API uint32_t jink_abi(void);
/** "0.1.0" */
JINK_API const char* jink_version(void);
/** One line; never null, also of a number that is no result. */
JINK_API const char* jink_error_text(jink_result result);

/** @param abi  JINK_ABI */
JINK_API jink_result jink_create(uint32_t abi, const jink_options* options, jink_coprocessor** created);
/** Null and unknown handles are ignored. */
JINK_API void jink_destroy(jink_coprocessor* jink);

/* --- bytes */

enum { JINK_PORT_AUTOPILOT = 0, JINK_PORT_CLOUD = 1 };

/** Bytes that arrived on a port since the last step; the next step reads them, up to 4096 (cloud: 163840).
 *  @param taken  how many of them, from the first; the rest does not fit now. May be null: then all or nothing, with
 *                JINK_ERROR_FULL. */
JINK_API jink_result jink_feed(jink_coprocessor* jink, int32_t port, const uint8_t* bytes, size_t count, size_t* taken);
/** Bytes for the autopilot, oldest first. Take all of them after every step: what waits here goes out old, and while
 *  4096 bytes wait, no new ones come. */
JINK_API jink_result jink_take(jink_coprocessor* jink, uint8_t* into, size_t capacity, size_t* taken);
/** Whether the line is there. A port that is not open loses what waits in it, and nothing is steered through it. All
 *  are open at first. */
JINK_API jink_result jink_set_open(jink_coprocessor* jink, int32_t port, int32_t is_open);

typedef struct jink_can_frame {
    uint32_t size;
    uint32_t id;      /**< 11 or 29 bits */
    uint8_t extended; /**< 1: 29 bits */
    uint8_t remote;   /**< 1: a remote frame */
    uint8_t length;   /**< 0 to 8 */
    uint8_t reserved; /**< 0 */
    uint8_t data[8];
} jink_can_frame;

enum { JINK_CAN_DOWN = 0, JINK_CAN_ACTIVE = 1, JINK_CAN_ERROR_PASSIVE = 2, JINK_CAN_BUS_OFF = 3 };

/** A classic frame that arrived. JINK_ERROR_FULL: 512 wait. */
JINK_API jink_result jink_feed_can(jink_coprocessor* jink, const jink_can_frame* frame);
/** The oldest frame to send. @param has_frame  1, or 0 where none waits, and `frame` is untouched */
JINK_API jink_result jink_take_can(jink_coprocessor* jink, jink_can_frame* frame, int32_t* has_frame);
/** Active at first. Frames that wait are lost when the controller goes down or leaves the bus. */
JINK_API jink_result jink_set_can_state(jink_coprocessor* jink, int32_t state);

/* --- steps */

/** One tick: reads, decides, writes. Every 20 ms; over 40 ms is late (JINK_FLAG_LATE), over 0.5 s JINK_FAULT_LATE.
 *  @param now_us  later than at the step before, read after the last byte was fed */
JINK_API jink_result jink_step(jink_coprocessor* jink, int64_t now_us);
/** Says CRITICAL and ends the stream of set-points, before the program stops. Take the bytes; no step follows. */
JINK_API jink_result jink_shut_down(jink_coprocessor* jink, int64_t now_us);

/* --- status */

/** jink_status.faults */
enum {
    JINK_FAULT_NO_AUTOPILOT = 1,
    JINK_FAULT_AUTOPILOT_SILENT = 2,
    JINK_FAULT_OWN_STATE_MISSING = 4,
    JINK_FAULT_OWN_STATE_STALE = 8,
    JINK_FAULT_PORT_LOST = 16,
    JINK_FAULT_LATE = 32,
    JINK_FAULT_NOT_FINITE = 64,
    JINK_FAULT_PASSIVE = 128,
    JINK_FAULT_BUS_LOST = 256,
    JINK_FAULT_AIRSPACE_UNPLACED = 512,
    JINK_FAULT_MAP_UNRESOLVED = 1024
};
/** jink_status.flags */
enum {
    JINK_FLAG_AUTOPILOT_HEARD = 1, /**< stack, flight_mode, custom_mode, system_id and the next four are known */
    JINK_FLAG_ARMED = 2,
    JINK_FLAG_LANDED = 4,
    JINK_FLAG_FIXED_WING = 8,
    JINK_FLAG_STEERABLE = 16,
    JINK_FLAG_OWN_STATE = 32,       /**< position, velocity, yaw and the nominal path are known */
    JINK_FLAG_HOME = 64,            /**< home and its place on the globe are known */
    JINK_FLAG_NOMINAL_IS_LEG = 128, /**< the nominal path is a leg of the mission; otherwise the measured motion */
    JINK_FLAG_WANTS_CONTROL = 256,  /**< `command` is valid */
    JINK_FLAG_CONFLICT = 512,       /**< the fields of the conflict are valid */
    JINK_FLAG_SETPOINT_SENT = 1024,
    JINK_FLAG_LATE = 2048,              /**< the step came late */
    JINK_FLAG_REACH_SETS_DAMAGED = 4096 /**< and are left out */
};
/** jink_status.system_state, MAV_STATE of the HEARTBEAT */
enum { JINK_BOOT = 1, JINK_STANDBY = 3, JINK_ACTIVE = 4, JINK_CRITICAL = 5, JINK_EMERGENCY = 6 };
/** jink_status.state, of the supervisor */
enum { JINK_WATCHING = 0, JINK_AVOIDING = 1, JINK_REJOINING = 2, JINK_BRAKING = 3 };
/** jink_status.control: who flies */
enum {
    JINK_CONTROL_AUTOPILOT = 0,
    JINK_CONTROL_ANNOUNCING = 1,
    JINK_CONTROL_REQUESTING = 2,
    JINK_CONTROL_OURS = 3,
    JINK_CONTROL_RETURNING = 4,
    JINK_CONTROL_REFUSED = 5,
    JINK_CONTROL_OVERRULED = 6
};
/** jink_status.own_source */
enum { JINK_OWN_NONE = 0, JINK_OWN_AUTOPILOT = 1, JINK_OWN_BUS = 2 };
/** jink_status.stack */
enum { JINK_STACK_UNKNOWN = 0, JINK_STACK_ARDUPILOT = 1, JINK_STACK_PX4 = 2 };
/** jink_status.flight_mode */
enum {
    JINK_MODE_UNKNOWN = 0,
    JINK_MODE_MISSION = 1,
    JINK_MODE_EXTERNAL = 2,
    JINK_MODE_HOLD = 3,
    JINK_MODE_GOING_HOME = 4,
    JINK_MODE_MANUAL = 5,
    JINK_MODE_OTHER = 6
};
/** jink_status.plan, of this step */
enum {
    JINK_PLAN_FOUND = 0,
    JINK_PLAN_NO_CONFLICT = 1,
    JINK_PLAN_TOO_CLOSE = 2,
    JINK_PLAN_NONE_AVAILABLE = 3,
    JINK_PLAN_BUDGET_SPENT = 4,
    JINK_PLAN_BAD_INPUT = 5,
    JINK_PLAN_RUNNING = 6
};
/** jink_status.manoeuvre */
enum { JINK_FOLLOW_PATH = 0, JINK_VELOCITY = 1, JINK_BRAKE = 2, JINK_HOLD_TURN = 3 };
/** jink_status.method: whose answer is flown or offered */
enum { JINK_METHOD_NONE = 0, JINK_METHOD_GEOMETRIC = 1, JINK_METHOD_REACH = 2, JINK_METHOD_RECIPROCAL = 3 };
/** jink_status.threat */
enum {
    JINK_THREAT_NONE = 0,
    JINK_THREAT_TRACK = 1,
    JINK_THREAT_OBSTACLE = 2,
    JINK_THREAT_FLOOR = 3,
    JINK_THREAT_CEILING = 4,
    JINK_THREAT_KEEP_IN = 5,
    JINK_THREAT_CLOSED_AREA = 6
};

/** As of the last step. What is not known is 0. */
typedef struct jink_status {
    uint32_t size;
    uint32_t flags;  /**< JINK_FLAG_... */
    uint32_t faults; /**< JINK_FAULT_... */
    int32_t system_state;
    int64_t time_us; /**< of the step; -1: none yet */
    int32_t state;
    int32_t control;
    int32_t own_source;
    int32_t stack;
    int32_t flight_mode;
    uint32_t custom_mode; /**< as on the wire */
    uint32_t system_id;   /**< of the autopilot */
    int32_t home_lat;     /**< [1e-7 deg] */
    int32_t home_lon;     /**< [1e-7 deg] */
    int32_t home_alt;     /**< above mean sea level [mm] */
    float home[3];        /**< [m] */
    float position[3];    /**< carried forward to time_us [m] */
    float velocity[3];    /**< [m/s] */
    float yaw;            /**< counter-clockwise from East [rad] */
    float nominal_end[3]; /**< end of the nominal path [m] */
    float nominal_speed;  /**< [m/s] */
    float command[3];     /**< [m/s] */
    float margin;         /**< least predicted margin of what is flown or offered [m] */
    int32_t plan;
    int32_t manoeuvre;
    uint32_t method;
    int32_t threat;             /**< of the conflict */
    float time_to_loss;         /**< until the safety box touches the threat [s] */
    float time_to_closest;      /**< until the closest approach [s] */
    float conflict_margin;      /**< then [m] */
    float miss_distance;        /**< between the centres then [m] */
    float own_at_closest[3];    /**< own position then [m] */
    float threat_at_closest[3]; /**< the threat's then [m] */
    uint32_t tracks;
    uint32_t obstacles;
    uint32_t closed_areas;
    uint32_t work;      /**< [work units] */
    uint32_t bytes_in;  /**< of the step */
    uint32_t bytes_out; /**< of the step */
    uint32_t reserved;  /**< 0 */
} jink_status;

JINK_API jink_result jink_get_status(const jink_coprocessor* jink, jink_status* status);

/** jink_track.source, jink_track_report.source */
enum { JINK_SOURCE_ADSB = 0, JINK_SOURCE_OWN_SENSOR = 1, JINK_SOURCE_DATALINK = 2, JINK_SOURCE_UTM = 3 };

typedef struct jink_track {
    uint32_t size;
    uint32_t id;
    uint32_t instance; /**< two aircraft under one id differ in it */
    int32_t source;
    int64_t stamp_us;     /**< of the newest measurement */
    float position[3];    /**< at the time of the last step [m] */
    float velocity[3];    /**< [m/s] */
    float radius;         /**< [m] */
    float sigma_position; /**< one standard deviation per axis, at the stamp [m] */
    float sigma_velocity; /**< [m/s] */
    float half_height;    /**< further uncertainty of the height [m] */
    uint32_t is_cooperative;
    uint32_t reserved; /**< 0 */
} jink_track;

/** @param index  below jink_status.tracks, which is 0 while the own position is not known */
JINK_API jink_result jink_get_track(jink_coprocessor* jink, uint32_t index, jink_track* track);

/** Counts since jink_create(). */
typedef struct jink_counters {
    uint32_t size;
    uint32_t steps, steps_late, setpoints, setpoints_withheld;
    uint32_t frames_in, frames_out, frames_refused,
        reports_refused; /**< of the link; refused: non-finite, out of range, stale */
    uint32_t inbox_full, outbox_full;
    uint32_t own_states, own_states_refused, autopilot_reboots;
    uint32_t tracks_created, tracks_replaced, tracks_expired, track_reports_refused;
    uint32_t conflicts, plans, plans_found, answers_rejected, manoeuvres, brakes, escapes, blocked;
    uint32_t take_overs, given_back, refused, overruled, lost_by_fault;
    uint32_t parameters_set, parameters_refused;
    uint32_t closed_areas_refused, closed_areas_merged;
    uint32_t caller_reports, caller_reports_refused; /**< of jink_report_...; refused: stamped later than the step */
    uint64_t autopilot_bytes_in, autopilot_bytes_out, cloud_bytes_in;
} jink_counters;

JINK_API jink_result jink_get_counters(const jink_coprocessor* jink, jink_counters* counters);

/* --- parameters: docs/guides/parameters.md */

typedef struct jink_parameter {
    uint32_t size;
    uint32_t is_integer;
    const char* name; /**< both for as long as the program runs */
    const char* text; /**< meaning and unit */
    float initial;
    float low;
    float high;
    uint32_t reserved; /**< 0 */
} jink_parameter;

JINK_API uint32_t jink_parameter_count(void);
JINK_API jink_result jink_get_parameter_info(uint32_t index, jink_parameter* info);
JINK_API jink_result jink_get_parameter(const jink_coprocessor* jink, const char* name, float* value);
JINK_API jink_result jink_set_parameter(jink_coprocessor* jink, const char* name, float value);
/** Several at once, all or none. Before the first step they are checked together. Later each comes into force in the
 *  next step, as by PARAM_SET, in this order: each has to fit when its turn comes. JINK_ERROR_FULL: 16 a step. */
JINK_API jink_result jink_set_parameters(jink_coprocessor* jink, const char* const* names, const float* values,
                                         size_t count);

/* --- what the caller's own sensors see; valid for the next step */

typedef struct jink_track_report {
    uint32_t size;
    uint32_t id; /**< the same one for the same vehicle; not 0 */
    int32_t source;
    uint32_t has_velocity;
    int64_t stamp_us;     /**< of the measurement, not later than the next step */
    float position[3];    /**< [m] */
    float velocity[3];    /**< [m/s] */
    float radius;         /**< [m]; 0: TRK_RADIUS */
    float sigma_position; /**< one standard deviation per axis [m]; 0: TRK_SIGMA_P */
    float sigma_velocity; /**< [m/s]; 0: TRK_SIGMA_V */
    uint32_t is_unmanned;
} jink_track_report;

/** Another vehicle. JINK_ERROR_FULL: as many as a step takes wait. */
JINK_API jink_result jink_report_track(jink_coprocessor* jink, const jink_track_report* report);

typedef struct jink_range_report {
    uint32_t size;
    uint32_t sensor;    /**< 0 to 255: which of several */
    int64_t stamp_us;   /**< of the measurement */
    float direction[3]; /**< from the vehicle; any length above 0 */
    float range;        /**< [m]; negative: nothing within max_range */
    float max_range;    /**< [m] */
    float half_angle;   /**< of the beam, 0 to 1.5 [rad] */
} jink_range_report;

/** A range finder's reading. JINK_ERROR_FULL: as many as a step takes wait. */
JINK_API jink_result jink_report_range(jink_coprocessor* jink, const jink_range_report* report);

/** An upright cylinder between two heights, at rest or in straight level motion. */
typedef struct jink_closed_area {
    uint32_t size;
    uint32_t has_place; /**< 1: `centre` is relative to lat, lon, alt; 0: it is in the local frame */
    int32_t lat;        /**< [1e-7 deg] */
    int32_t lon;        /**< [1e-7 deg] */
    int32_t alt;        /**< above mean sea level [mm] */
    float centre[2];    /**< East, North [m] */
    float velocity[2];  /**< [m/s] */
    float radius;       /**< [m], > 0 */
    float bottom;       /**< [m] */
    float top;          /**< [m], not below the bottom */
    float margin;       /**< kept off where there is a way that does [m], >= 0 */
    uint32_t reserved;  /**< 0 */
    int64_t stamp_us;   /**< of `centre` */
    int64_t ends_us;    /**< open afterwards; 0: never */
} jink_closed_area;

/** What is closed from now on, in place of all that was set before, here or over the link. All or none.
 *  @param now_us  the present time, not before the last step; no stamp is later
 *  @param count   up to JINK_MAX_CLOSED_AREAS; 0: nothing is closed, and `areas` may be null */
JINK_API jink_result jink_set_closed_areas(jink_coprocessor* jink, int64_t now_us, const jink_closed_area* areas,
                                           size_t count);

#ifdef __cplusplus
}
#endif

#endif
