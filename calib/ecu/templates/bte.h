{% from "members.j2" import members, variables %}
/* Brake torque of each axle from wheel speeds, deceleration and pressure: brake-cal's estimator.
 *
 *     sample --means over a block--> zeros, level, lag, slip, ratio --> friction, torque, bounds
 *
 * SI units. No memory is allocated, nothing is recursive, and of math.h only sqrt, fabs, frexp and
 * ldexp are called, which have the same bits everywhere. One code serves any number of cars.
 * One task calls all functions of one `bte_state`:
 *
 *     bte_init(&state, &bte_car_NAME);                 at power-on, and after a reset
 *     bte_reason reason = bte_step(&state, &inputs);   once every `sample_time` of the car
 *     state.answers.brake_torque_fl.median             until the next call
 */
#ifndef BTE_H
#define BTE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BTE_LAYOUT {{ layout }} /* checksum of this file: of its structures */

typedef {{ real }} bte_real;
typedef {{ cell }} bte_cell; /* of the maps */

/* An ECU project may define two macros before this file: the qualifiers of the calibration data,
 * `const volatile` if a tool changes them, and an attribute of their definitions, a section. */
#ifndef BTE_CAL
#define BTE_CAL const
#endif
#ifndef BTE_CAL_DATA
#define BTE_CAL_DATA
#endif

/* Why an answer does not hold. */
typedef enum {
{% for x in reasons %}
    BTE_{{ x.name }} = {{ x.value }}, /* {{ x.words }} */
{% endfor %}
} bte_reason;

/* What the sensors read at one time. */
typedef struct {
{{ variables("bte_real", inputs) -}}
} bte_inputs;

/* An answer with its 95 % bounds. */
typedef struct {
    bte_real median, lower, upper;
} bte_interval;

/* The answers, which are finite whatever the reason. */
typedef struct {
{{ variables("bte_interval", answers) -}}
} bte_answers;

enum { BTE_FRONT, BTE_REAR, BTE_AXLES, BTE_WHEELS = 4, BTE_INPUTS = {{ inputs | length }} };

/* Bits of `diagnosis`: first one for each input that is out of its range or jumps, then these. */
enum {
{% for check in checks %}
    BTE_{{ check.upper() }}{{ " = BTE_INPUTS" if loop.first }},
{% endfor %}
    BTE_DIAGNOSES
};

/* Axes of maps: deceleration z [1], (eta - 1)/z, slip [standard deviations]; the points rise. */
enum { BTE_Z, BTE_SHIFT, BTE_SLIP, BTE_MAP_AXES };
enum { BTE_COLUMNS = 3 }; /* most columns of a map */
typedef struct {
    BTE_CAL bte_real *x;
    uint16_t count;
} bte_axis;

/* A map: columns of cells over its axes; a value is a cell times the `step` of its column. Values
 * are linear between the points, and constant beyond the ends of the axes. */
typedef struct {
    bte_axis axis[BTE_MAP_AXES];
    uint16_t axes, columns;
    BTE_CAL bte_cell *cells[BTE_COLUMNS];
    bte_real step[BTE_COLUMNS];
} bte_map;

/* The numbers of a car, all of one type. */
typedef struct {
{% for x in numbers %}
    bte_real {{ x.name }}{{ sizes[x.parts] }};{% if x.comment %} /* {{ x.comment }} */{% endif %}

{% endfor %}
} bte_numbers;

/* The data of a car: layout, size and checksum by which they are accepted; numbers and maps. */
typedef struct {
    uint32_t layout, size, checksum;
    uint16_t samples, waiting; /* samples in a block; blocks before a bite that show no zero */
    BTE_CAL bte_numbers *numbers;
    bte_map pads, slip, level, prior;
    bte_axis tyre;
    BTE_CAL bte_real *tyre_slip;
} bte_car;

/* Zeros of signals, Kalman filters of brakes and speed, their checks and means. */
{% for name, declared in structures.items() %}
typedef struct {
{{ members(declared) -}}
} {{ name }};

{% endfor %}
typedef struct {
{{ members(filters) -}}
} bte_filters;

/* Means over a block [SI]; forces are over the weight of the car. */
typedef struct {
    bte_real {{ block | join(", ") }};
} bte_block;

/* Sums over the samples of a block. */
typedef struct {
    bte_real p_mc, z, omega_f, apart, drive_f, drive_r; /* apart: rear less front wheels */
} bte_sums_of_block;

/* Readings of a rolling block, from which the zeros are learned. */
typedef struct {
    bte_real demand, eta_less_1, rim;
} bte_rolling;

/* The state. A calibration tool measures the members up to `filters`. */
typedef struct {
    uint32_t reason, layout, diagnosis; /* diagnosis: a bit for each input or check that fails */
    uint32_t lasted[BTE_DIAGNOSES]; /* number of calls in which it failed */
    uint16_t often[BTE_DIAGNOSES]; /* number of times that it began to fail */
    bte_inputs last; /* last good readings */
    bte_answers answers;
    bte_filters filters;
    const bte_car *car;
    bte_real ratio[3]; /* ln of the held ratio of the pads, with its bounds */
    bool started, block_full;    /* whether a sample, a block was taken */
    bool faulty, failed, driven; /* a sensor failed in the last block, in this one; accelerated */
    uint16_t count, checks;
    uint32_t seal, waits;
    bte_rolling waiting[3];
    bte_real raw[BTE_INPUTS], wheels[BTE_WHEELS][2]; /* last readings in range; last two speeds */
    bte_real fastest, lateral, since_lock, since_abs, omega[BTE_AXLES];
    bte_sums_of_block sum;
    bte_reason worst, block_reason;
} bte_state;

typedef enum {
    BTE_READY,
    BTE_CALIBRATED, /* ready, but the checksum differs: a tool changed the data, or a fault did */
    BTE_REFUSED     /* data of another bte.h or compiler: every answer is 0, the reason BTE_FAULT */
} bte_status;

/* Forget everything, and take the data of a car. */
bte_status bte_init(bte_state *state, const bte_car *car);

/* Take in a sample; return the reason of `state->answers`. */
bte_reason bte_step(bte_state *state, const bte_inputs *x);

/* Take other data of a car that rests. The zeros of a_x and eta and the lag of the brakes last, all
 * else begins anew. False, and nothing is done, while the car rolls or if the data are refused. */
bool bte_exchange(bte_state *state, const bte_car *car);

/* After a reset: go on with a state that the RAM kept, if its checksum is right; as bte_exchange.
 * False, and nothing is done, if it is not: then call bte_init. */
bool bte_resume(bte_state *state, const bte_car *car);

#ifdef __cplusplus
}
#endif

#endif
