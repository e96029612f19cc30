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

#define BTE_LAYOUT {{ layout }} /* of the structures below, by their text */

typedef {{ real }} bte_real;
typedef {{ cell }} bte_cell; /* of the maps */

/* Defined before this file: qualifiers of the calibration data, as `const volatile` where a tool
 * changes them, and what stands before their definitions, as an attribute with a section. */
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

/* With its 95 % bounds. */
typedef struct {
    bte_real median, lower, upper;
} bte_interval;

/* What is answered, finite at any reason. */
typedef struct {
{{ variables("bte_interval", answers) -}}
} bte_answers;

enum { BTE_FRONT, BTE_REAR, BTE_AXLES, BTE_WHEELS = 4, BTE_INPUTS = {{ inputs | length }} };

/* Bits of `diagnosis`: an input that is out of its range or jumps, by its place, then these. */
enum {
{% for check in checks %}
    BTE_{{ check.upper() }}{{ " = BTE_INPUTS" if loop.first }},
{% endfor %}
    BTE_DIAGNOSES
};

/* Axes of maps: deceleration, (eta - 1)/z, slip in standard deviations; rising points. */
enum { BTE_Z, BTE_SHIFT, BTE_SLIP, BTE_MAP_AXES };
enum { BTE_COLUMNS = 3 };
typedef struct {
    BTE_CAL bte_real *x;
    uint16_t count;
} bte_axis;

/* Columns over as many axes, linear between the points and held beyond their ends; cells times
 * `step` are the values. */
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

/* The data of a car: of which bte.h, how large, with which sum; numbers and maps. */
typedef struct {
    uint32_t layout, size, checksum;
    uint16_t samples, waiting; /* of a block; blocks on which no zero rests */
    BTE_CAL bte_numbers *numbers;
    bte_map pads, slip, level, prior;
    bte_axis tyre;
    BTE_CAL bte_real *tyre_slip;
} bte_car;

/* What a signal reads while nothing brakes, Kalman filters of brakes and speed, and their sums. */
{% for name, declared in structures.items() %}
typedef struct {
{{ members(declared) -}}
} {{ name }};

{% endfor %}
typedef struct {
{{ members(filters) -}}
} bte_filters;

/* Means over a block [SI], as the estimator takes them in; forces over the weight. */
typedef struct {
    bte_real {{ block | join(", ") }};
} bte_block;

/* Sums over the samples of a block. */
typedef struct {
    bte_real p_mc, z, omega_f, apart, drive_f, drive_r; /* apart: rear less front wheels */
} bte_sums_of_block;

/* What a block of a car that rolls reads, of which zeros are learned. */
typedef struct {
    bte_real demand, eta_less_1, rim;
} bte_rolling;

/* All that is remembered. A tool measures the members up to `filters`; calibration data do not
 * move. */
typedef struct {
    uint32_t reason, layout, diagnosis; /* bits of what fails */
    uint32_t lasted[BTE_DIAGNOSES]; /* in how many calls each failed */
    uint16_t often[BTE_DIAGNOSES]; /* how often each began to */
    bte_inputs last; /* good readings */
    bte_answers answers;
    bte_filters filters;
    const bte_car *car;
    bte_real ratio[3]; /* ln of the best informed one, with its bounds */
    bool started, block_full, faulty, failed, driven;
    uint16_t count, checks;
    uint32_t seal, waits;
    bte_rolling waiting[3];
    bte_real raw[BTE_INPUTS], wheels[BTE_WHEELS][2]; /* the last readings */
    bte_real fastest, lateral, since_lock, since_abs, omega[BTE_AXLES];
    bte_sums_of_block sum;
    bte_reason worst, block_reason;
} bte_state;

typedef enum {
    BTE_READY,
    BTE_CALIBRATED, /* ready, but the data differ from their sum: a tool changed them, or a fault */
    BTE_REFUSED     /* data of another bte.h or compiler: every answer is 0, its reason a fault */
} bte_status;

/* Forget everything, and take the data of a car. */
bte_status bte_init(bte_state *state, const bte_car *car);

/* Take in a sample; the reason of `state->answers`. */
bte_reason bte_step(bte_state *state, const bte_inputs *x);

/* Take other data: true at rest, false while it rolls or if they are refused, and nothing is done.
 * What a_x and eta read while nothing brakes, and the lag of the brakes, last; all else begins. */
bool bte_exchange(bte_state *state, const bte_car *car);

/* After a reset, before bte_init, of a state in RAM that it spared: true if its seal is whole. The
 * same lasts. False: call bte_init. */
bool bte_resume(bte_state *state, const bte_car *car);

#ifdef __cplusplus
}
#endif

#endif
