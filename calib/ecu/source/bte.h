/* Brake torque of each axle from wheel speeds, deceleration and pressure: the estimator of
 * brake-cal.
 *
 *     sample --means over a block--> zeros, level, lag, slip, ratio --> friction, torque, bounds
 *
 * Every number of a car is in `bte_car`, which bte_car.c defines. SI units. No memory is allocated,
 * nothing is recursive, and of the C library only sqrt is called. One task calls all functions of
 * one `bte_state`.
 *
 *     static bte_state state;
 *     bte_init(&state, &bte_this_car);                 at power-on, and after a reset
 *     bte_reason reason = bte_step(&state, x, y);      once every `sample_time` of the car
 */
#ifndef BTE_H
#define BTE_H

#include <stdbool.h>
#include <stdint.h>

#include "bte_config.h" /* BTE_FLOAT: 32 or 64; BTE_CELL: type of the cells of the maps */

#ifdef __cplusplus
extern "C" {
#endif

#if BTE_FLOAT == 64
typedef double bte_real;
#else
typedef float bte_real;
#endif
typedef BTE_CELL bte_cell;

/* Defined before this file: qualifiers of the calibration data, as `const volatile` where a tool
 * changes them, and what stands before their definitions, as an attribute with a section. */
#ifndef BTE_CAL
#define BTE_CAL const
#endif
#ifndef BTE_CAL_DATA
#define BTE_CAL_DATA
#endif

/* Why an answer does not stand: the first that applies. */
typedef enum {
    BTE_VALID = 0,
    BTE_NOT_BRAKED = 1,   /* the pressure is low */
    BTE_TURNED = 2,       /* the wheel is turned */
    BTE_CORNERS = 3,      /* the car corners */
    BTE_LOCKED = 4,       /* a wheel locks, or ABS works; for 1 s after it, too */
    BTE_SLOW = 5,         /* below 3 m/s, and at rest */
    BTE_JUST_APPLIED = 6, /* the brake has just been applied */
    BTE_NO_PAD = 7,       /* no pad has such a friction */
    BTE_BEYOND_MAP = 8,   /* no stop that the table knows shows such an eta */
    BTE_FAULT = 9         /* a sensor is out of its range, no number, or frozen */
} bte_reason;

enum { BTE_FL, BTE_FR, BTE_RL, BTE_RR, BTE_WHEELS };
enum { BTE_FRONT, BTE_REAR, BTE_AXLES };

/* What the sensors read at one time, x[BTE_INPUTS]; bte_car.c has their ranges. */
enum {
    BTE_P_MC,                                   /* master-cylinder pressure [Pa] */
    BTE_A_X,                                    /* acceleration, forward positive [m/s^2] */
    BTE_OMEGA,                                  /* wheel speeds, BTE_OMEGA + BTE_FL .. [rad/s] */
    BTE_STEERING = BTE_OMEGA + BTE_WHEELS,      /* at the driver's wheel [rad]; 0 if unknown */
    BTE_DRIVEN,                                 /* 1 while the accelerator is pressed; 0 unknown */
    BTE_DRIVE,                                  /* torque of engine or motor at both wheels of an
                                                   axle [N m], negative where it slows; 0 unknown */
    BTE_INPUTS = BTE_DRIVE + BTE_AXLES
};

/* What is answered, y[BTE_ANSWERS][BTE_BOUNDS]: medians with 95 % bounds, finite at any reason. */
enum { BTE_MEDIAN, BTE_LOWER, BTE_UPPER, BTE_BOUNDS };
enum {
    BTE_LEVEL,          /* brake torque over that of filed pads [1] */
    BTE_RATIO,          /* front pads over rear pads [1] */
    BTE_PAD_FRICTION_F, /* [1] */
    BTE_PAD_FRICTION_R,
    BTE_BRAKE_TORQUE_F, /* of one wheel of the axle [N m] */
    BTE_BRAKE_TORQUE_R,
    BTE_BRAKE_TORQUE_SUM, /* of all wheels [N m] */
    BTE_ANSWERS
};

enum { BTE_Z, BTE_SHIFT, BTE_SLIP, BTE_MAP_AXES };

/* A value over rising points. Maps are read linearly between cells and held beyond their ends. */
typedef struct {
    BTE_CAL bte_real *x;
    uint16_t count;
} bte_axis;

/* The cell of an axis: its first point, and how far x is along it, from 0 to 1. */
typedef struct {
    uint16_t at;
    bte_real along;
} bte_place;

#ifdef BTE_FIND /* a search of your own; the last point has `along` 1 in the last cell */
bte_place BTE_FIND(const bte_axis *axis, bte_real x);
#endif

typedef struct {
    bte_real noise_rim, noise_z; /* densities of the sensors' noise [m/s s^0.5], [s^0.5] */
    bte_real memory, before_bite, untouched, settle, least_pressure, least_z, usual_z, least_mean_z;
    bte_real least_share, least_level, most_level, level_sigma, level_walk, fade, fade_walk, jump;
    bte_real level_rough, lag, lag_sigma, lag_rough, least_lag, apart, zero, offset, bias_walk;
    bte_real grade_walk, scale, scale_sigma, ageing, unlike, slip_rough, log_slip, log_slip_sigma;
    bte_real slip_walk, slip_bends; /* see calib/estimation/constants.py */
    bte_real bite, moving, steady, radius_walk, slowest, rests, held_time, held_pressure;
    bte_real steering, lateral, lock, recover, slows, turning; /* calib/estimation/reasons.py */
} bte_tuning;

/* Cells times `step` are the values. */
typedef struct {
    BTE_CAL bte_cell *cells;
    bte_real step;
} bte_map;

typedef struct {
    BTE_CAL bte_real *version; /* of the table */
    bte_tuning tuning;
    bte_real low[BTE_INPUTS], high[BTE_INPUTS], jump[BTE_INPUTS]; /* what a working sensor reads */
    uint16_t samples, waiting;         /* in a block; blocks before a bite on which no zero rests */
    bte_real sample_time, block;       /* [s] */
    bte_real lateral_part;             /* of a sample in the low pass of sideways motion [1] */
    bte_real weight;                   /* [N] */
    bte_real load[BTE_AXLES], height;  /* loads at rest, and that moves at 1 g, over weight [1] */
    bte_real track_width, cg_height;   /* [m] */
    bte_real drag;                     /* air drag over the square of the speed [N s^2/m^2] */
    bte_real drag_lift;                /* load that moves from front to rear by drag [1] */
    bte_real rolling, rolling_growth;  /* resistance over load [1], and how it grows with v^2 */
    bte_real radius[BTE_AXLES];        /* [m] */
    bte_real turning_mass[BTE_AXLES];  /* of an axle's wheels, at the road [kg] */
    bte_real torque_gain[BTE_AXLES];   /* torque of a wheel over pressure and friction [m^3] */
    bte_real pad_friction[BTE_AXLES];  /* of the vehicle file [1] */
    bte_real force;                    /* of both axles over the pressure with these pads [N/Pa] */
    bte_real share;                    /* of the front axle in it [1] */
    bte_real ramp_share[BTE_AXLES];    /* of the axles in it with the pads of the ramp [1] */
    bte_real ramp_ratio;               /* ln of the pads' ratio on the ramp */
    bte_axis tyre;                     /* normalised force, and the slip at it [1] */
    BTE_CAL bte_real *tyre_slip;
    bte_axis axes[BTE_MAP_AXES];           /* of `ratio`; the maps of the slip have the first two */
    bte_map ratio[BTE_BOUNDS], slip_mean, slip_sigma;
    bte_axis level_z;                  /* of the level, and of the ratio before eta is read */
    bte_map level[BTE_BOUNDS], before[BTE_BOUNDS];
} bte_car;

/* A Gaussian that walks: what a signal reads while nothing brakes. */
typedef struct {
    bte_real value, variance;
} bte_zero;

/* Means over a block, as the estimator takes them in. */
typedef struct {
    bte_real demand, nominal, pressure, z, eta_less_1, rim, rear_share;
} bte_block;

/* A Gaussian of several states: values and covariances. */
enum { BTE_STATES = 4, BTE_SIGNALS = 6 };
typedef struct {
    bte_real x[BTE_STATES], p[BTE_STATES][BTE_STATES];
} bte_gauss;

/* All that is remembered; of no use outside of bte.c, but for RAM that must survive a reset. */
typedef struct {
    const bte_car *car;
    bte_zero demand, eta_less_1;
    bte_gauss level, speed;
    bool anchored, started, block_full, faulty, driven;
    uint8_t waits;
    bte_block waiting[4];
    bte_real nominal, acting, by_lag, z, braked, released, sums[4], mean_z;
    bte_real kept[BTE_BOUNDS], age, level_then;
    /* of the samples, and of those of a block the first and what the others differ from it */
    bte_real last[BTE_INPUTS], raw[BTE_INPUTS], before[BTE_WHEELS][2];
    bte_real fastest, lateral, since_lock, p_held, held;
    bte_real first[BTE_SIGNALS], sum[BTE_SIGNALS], omega[BTE_AXLES];
    uint16_t count;
    bte_reason worst, reason;
    bte_real told[BTE_BRAKE_TORQUE_F][BTE_BOUNDS]; /* of the last block; torques follow */
} bte_state;

/* Forget everything. */
void bte_init(bte_state *state, const bte_car *car);

/* Take in a sample, and answer; the reason of the answer. */
bte_reason bte_step(bte_state *state, const bte_real x[BTE_INPUTS],
                    bte_real y[BTE_ANSWERS][BTE_BOUNDS]);

/* Take another car's numbers and forget everything: true at rest, false while it rolls. */
bool bte_exchange(bte_state *state, const bte_car *car);

/* The answer of the last block, with the torques at a pressure [Pa]. */
void bte_told(const bte_state *state, bte_real p_mc, bte_real y[BTE_ANSWERS][BTE_BOUNDS]);

extern const bte_car bte_this_car;

#ifdef __cplusplus
}
#endif

#endif
