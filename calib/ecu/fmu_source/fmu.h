/* One instance of an FMU: its numbers by reference, and its steps. fmi2.c and fmi3.c call it.
 *
 * A function returns NULL, or what is wrong; then nothing has changed.
 */
#ifndef FMU_H
#define FMU_H

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "bte.h"
#include "fmu_config.h" /* FMU_NAME, FMU_TOKEN, FMU_SAMPLE_TIME [s] */

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the parameters are those of the standard */
#endif

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

/* References: the members of bte_sample, those of bte_output from `level` on, the reason, time. */
enum { INPUTS = 10, OUTPUTS = 21, REASON = INPUTS + OUTPUTS, TIME };

typedef struct {
    bte_real reals[INPUTS + OUTPUTS];
    bte_reason reason;
    double time; /* [s] */
    bte_state state;
} fmu;

static void keep_told(fmu *x, const bte_output *told) {
    const char *reals = (const char *)told + offsetof(bte_output, level);
    memcpy(x->reals + INPUTS, reals, OUTPUTS * sizeof(bte_real));
    x->reason = told->reason;
}

static void start(fmu *x) {
    bte_output told;
    memset(x->reals, 0, sizeof x->reals);
    bte_init(&x->state, &bte_this_car);
    bte_told(&x->state, (bte_real)0.0, &told);
    keep_told(x, &told);
    x->time = 0.0;
}

static const char *get_reals(const fmu *x, const uint32_t at[], size_t count, double values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] >= REASON && at[i] != TIME) {
            return "no real variable has this value reference";
        }
        values[i] = at[i] == TIME ? x->time : (double)x->reals[at[i]];
    }
    return NULL;
}

static const char *get_reason(const fmu *x, const uint32_t at[], size_t count, int32_t values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] != REASON) {
            return "no integer variable has this value reference";
        }
        values[i] = (int32_t)x->reason;
    }
    return NULL;
}

static const char *set_reals(fmu *x, const uint32_t at[], size_t count, const double values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] >= INPUTS) {
            return "no input has this value reference";
        }
    }
    for (size_t i = 0; i < count; i++) {
        x->reals[at[i]] = (bte_real)values[i];
    }
    return NULL;
}

/* From `time` on by `length` [s], with the inputs held. */
static const char *advance(fmu *x, double time, double length) {
    const double exact = length / FMU_SAMPLE_TIME;
    const uint32_t steps = exact > 0.5 && exact < 4e9 ? (uint32_t)(exact + 0.5) : 0U;
    if (steps == 0U || exact - steps > 1e-6 || exact - steps < -1e-6) {
        return "the communication step is no multiple of " TEXT(FMU_SAMPLE_TIME) " s";
    }
    bte_sample sample;
    bte_output told;
    memcpy(&sample, x->reals, sizeof sample);
    for (uint32_t i = 0; i < steps; i++) {
        bte_step(&x->state, &sample, &told);
    }
    keep_told(x, &told);
    x->time = time + length;
    return NULL;
}

#endif
