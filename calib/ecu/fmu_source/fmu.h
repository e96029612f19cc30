/* One instance of an FMU: its numbers by reference, and its steps. fmi2.c and fmi3.c call it, and
 * model.h, which is estimator.h or car.h, has what it is of:
 *
 *     model_start(model, given, told), model_step(model, given, told)     both return the reason
 *
 * A function here returns NULL, or what is wrong; then nothing has changed.
 */
#ifndef FMU_H
#define FMU_H

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "fmu_config.h" /* FMU_NAME, FMU_TOKEN, FMU_SAMPLE_TIME [s], FMU_TOLD, first_given */
#include "model.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the parameters are those of the standard */
#endif

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

/* References: inputs and parameters, outputs, the reason, time. */
enum { GIVEN = sizeof first_given / sizeof first_given[0], REASON = GIVEN + FMU_TOLD, TIME };

typedef struct {
    double reals[REASON];
    int32_t reason;
    double time; /* [s] */
    model model;
} fmu;

static const char *start(fmu *x) {
    x->reason = model_start(&x->model, x->reals, x->reals + GIVEN);
    return NULL;
}

static const char *reset(fmu *x) {
    memcpy(x->reals, first_given, sizeof first_given);
    x->time = 0.0;
    return start(x);
}

static const char *begin_at(fmu *x, double time) {
    x->time = time;
    return NULL;
}

static const char *get_reals(const fmu *x, const uint32_t at[], size_t count, double values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] >= REASON && at[i] != TIME) {
            return "no real variable has this value reference";
        }
        values[i] = at[i] == TIME ? x->time : x->reals[at[i]];
    }
    return NULL;
}

static const char *get_reason(const fmu *x, const uint32_t at[], size_t count, int32_t values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] != REASON) {
            return "no integer variable has this value reference";
        }
        values[i] = x->reason;
    }
    return NULL;
}

static const char *set_reals(fmu *x, const uint32_t at[], size_t count, const double values[]) {
    for (size_t i = 0; i < count; i++) {
        if (at[i] >= GIVEN) {
            return "no input or parameter has this value reference";
        }
    }
    for (size_t i = 0; i < count; i++) {
        x->reals[at[i]] = values[i];
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
    for (uint32_t i = 0; i < steps; i++) {
        x->reason = model_step(&x->model, x->reals, x->reals + GIVEN);
    }
    x->time = time + length;
    return NULL;
}

#endif
