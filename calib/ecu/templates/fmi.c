/* An FMU for co-simulation in FMI {{ version }}, with the headers of the tool that compiles it.
 *
 * {{ content }}.h has the state of the model, and model_step(state, numbers, first), which writes
 * the outputs after a sample time, or the first ones. fmi{{ version }}.h has what this version alone has.
 */
#include <fmi{{ version }}Functions.h>
#include <math.h>
#include <string.h>

#include "bte.h"
extern const bte_car {{ data }};

#define SAMPLE_TIME {{ step }} /* [s] */
#define FMI(name) fmi{{ version }}##name

/* References: the GIVEN inputs and parameters, the outputs, the time [s], the reason. */
enum { {{ references }}, COUNT, GIVEN = {{ given }} };
static const double first_numbers[COUNT] = { {{- first -}} };
#include "{{ content }}.h"

typedef struct {
    double numbers[COUNT];
    model state;
    void (*log)(void), *host; /* of the tool; the type of its logger is that of the version */
} instance;

static instance *new_instance(const char *token, void (*log)(void), void *host) {
    instance *x = strcmp(token, "{{ token }}") == 0 ? calloc(1, sizeof *x) : NULL;
    if (x != NULL) {
        *x = (instance){.log = log, .host = host};
        FMI(Reset)(x);
    }
    return x;
}

/* Go on from `time` by `length` [s], the inputs held. Return NULL, or what forbids it. */
static const char *advance(instance *x, double time, double length) {
    const double exact = length / SAMPLE_TIME, steps = floor(exact + 0.5);
    if (!(steps > 0.0 && steps < 4e9 && fabs(exact - steps) < 1e-6)) {
        return "the communication step is no multiple of {{ step }} s";
    }
    for (uint32_t i = 0; i < steps; i++) {
        model_step(&x->state, x->numbers, false);
    }
    x->numbers[TIME] = time + length;
    return NULL;
}

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the parameters are those of the standard */
#endif

/* A function of the standard, whose body uses the instance x or says what is `wrong`. */
#define FUNCTION(name, parameters, body) \
    FMI(Status) FMI(name) parameters { \
        instance *x = c; \
        const char *wrong = NULL; \
        body; \
        if (wrong != NULL && x->log != NULL) { TELL(wrong); } \
        return wrong == NULL ? FMI(OK) : FMI(Error); \
    }
#define ABSENT(name, parameters) FUNCTION(name, parameters, wrong = "it is not offered")
#define ONLY (void *c) /* parameters: the instance, alone or with a value */
#define WITH(type) (void *c, type value)

/* A function of SOME variables, by `count` references `at`. `copy` runs for each of them, if `known`
 * holds for all. */
#define SOME void *c, const uint32_t at[], size_t count
#define SEEDS SOME, const uint32_t by[], size_t bys, const double seed[]
#define FOR_EACH(name, parameters, known, copy) \
    FUNCTION(name, parameters, \
         for (size_t i = 0; i < count; i++) { wrong = (known) ? wrong : "no such variable"; } \
         for (size_t i = 0; i < count && wrong == NULL; i++) { copy; })
#define GET(type, known) \
    FOR_EACH(Get##type, VALUES(FMI(type)), known, values[i] = x->numbers[at[i]])
#define SET(type, known) \
    FOR_EACH(Set##type, VALUES(const FMI(type)), known, x->numbers[at[i]] = values[i])
#define NONE_OF(type) \
    FOR_EACH(Get##type, VALUES(FMI(type)), false, ) \
    FOR_EACH(Set##type, VALUES(const FMI(type)), false, )

#define SET_TIME(name) \
    FUNCTION(name, (void *c, FMI(Boolean) tolerant, double tolerance, double time, \
                    FMI(Boolean) ends, double end), x->numbers[TIME] = time)

/* The functions of states. A state is a copy of an instance. Another host may have made it, so its
 * pointers are not taken over. */
#define STATES(State, Deserialize) \
    FUNCTION(Get##State, WITH(void **), \
         instance *copy = *value == NULL ? malloc(sizeof *x) : *value; \
         if (copy == NULL) { wrong = "no memory"; } else { *copy = *x; *value = copy; }) \
    FUNCTION(Set##State, WITH(void *), \
         const instance *copy = value; \
         (void)memcpy(x->numbers, copy->numbers, sizeof x->numbers); \
         x->state = copy->state) \
    FUNCTION(Free##State, WITH(void **), free(*value); *value = NULL) \
    FUNCTION(Serialized##State##Size, (void *c, void *state, size_t *size), *size = sizeof *x) \
    FUNCTION(Serialize##State, (void *c, void *state, FMI(Byte) bytes[], size_t size), \
         if (size < sizeof *x) { wrong = "the state is larger"; } \
         else { (void)memcpy(bytes, state, sizeof *x); }) \
    FUNCTION(Deserialize, (void *c, const FMI(Byte) bytes[], size_t size, void **state), \
         instance *copy = *state == NULL ? malloc(sizeof *x) : *state; \
         if (copy == NULL || size != sizeof *x) { wrong = "no state of this FMU"; } \
         else { (void)memcpy(copy, bytes, sizeof *x); *state = copy; })

#include "fmi{{ version }}.h"

const char *FMI(GetVersion)(void) { return FMI(Version); }
void FMI(FreeInstance)(void *c) { free(c); }
FUNCTION(Reset, ONLY, memcpy(x->numbers, first_numbers, sizeof first_numbers);
         model_step(&x->state, x->numbers, true))
FUNCTION(ExitInitializationMode, ONLY, model_step(&x->state, x->numbers, true))
FUNCTION(Terminate, ONLY, )
FUNCTION(SetDebugLogging, (void *c, FMI(Boolean) on, size_t n, const FMI(String) of[]), )
