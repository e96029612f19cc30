/* An FMU for co-simulation in FMI {{ version }}, with the headers of the tool that compiles it; more
 * functions are in fmi2.h or fmi3.h. estimator.h or car.h has model_step(state, numbers, first):
 * its outputs after a sample time, or at first.
 */
#include <fmi{{ version }}Functions.h>
#include <math.h>
#include <string.h>

#include "bte.h"
extern const bte_car {{ data }};

#define SAMPLE_TIME {{ step }} /* [s] */
#define FMI(name) fmi{{ version }}##name

/* References: inputs and parameters, which are GIVEN; outputs; time [s]; the reason. */
enum { {{ references }}, COUNT, GIVEN = {{ given }} };
static const double first_numbers[COUNT] = { {{- first -}} };
#include "{{ of }}.h"

typedef struct {
    double numbers[COUNT];
    model state;
    void (*log)(void), *host; /* of the tool; its logger is of a type of the version */
} instance;

static instance *new_instance(const char *token, void (*log)(void), void *host) {
    instance *x = strcmp(token, "{{ token }}") == 0 ? calloc(1, sizeof *x) : NULL;
    if (x != NULL) {
        *x = (instance){.log = log, .host = host};
        FMI(Reset)(x);
    }
    return x;
}

/* From `time` on by `length` [s], with the inputs held; NULL, or what is wrong and nothing done. */
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

/* A function of the standard: it `does` something with the instance x, or says what is `wrong`. */
#define DOES(name, parameters, does) \
    FMI(Status) FMI(name) parameters { \
        instance *x = c; \
        const char *wrong = NULL; \
        does; \
        if (wrong != NULL && x->log != NULL) { TELL(wrong); } \
        return wrong == NULL ? FMI(OK) : FMI(Error); \
    }
#define CANNOT(name, parameters) DOES(name, parameters, wrong = "this function is not offered")
#define ALONE (void *c)
#define AND(type) (void *c, type value)

/* It `copies` each of some variables, if the references of all are `right`. */
#define SOME void *c, const uint32_t at[], size_t count
#define BY SOME, const uint32_t by[], size_t bys, const double seed[]
#define EACH(name, parameters, right, copies) \
    DOES(name, parameters, \
         for (size_t i = 0; i < count; i++) { wrong = (right) ? wrong : "no such variable"; } \
         for (size_t i = 0; i < count && wrong == NULL; i++) { copies; })
#define GET(of, right) EACH(Get##of, VALUES(FMI(of)), right, values[i] = x->numbers[at[i]])
#define SET(of, right) EACH(Set##of, VALUES(const FMI(of)), right, x->numbers[at[i]] = values[i])
#define HAS_NO(of) \
    EACH(Get##of, VALUES(FMI(of)), false, ) EACH(Set##of, VALUES(const FMI(of)), false, )

#define BEGINS(name) DOES(name, (void *c, FMI(Boolean) tolerant, double tolerance, double time, \
                                 FMI(Boolean) ends, double end), x->numbers[TIME] = time)

/* A state is a copy of the instance; where it is taken up again, the host is another. */
#define KEEPS(State, Deserialize) \
    DOES(Get##State, AND(void **), \
         instance *copy = *value == NULL ? malloc(sizeof *x) : *value; \
         if (copy == NULL) { wrong = "no memory for a state"; } else { *copy = *x; *value = copy; }) \
    DOES(Set##State, AND(void *), take_up(x, value)) \
    DOES(Free##State, AND(void **), free(*value); *value = NULL) \
    DOES(Serialized##State##Size, (void *c, void *state, size_t *size), *size = sizeof *x) \
    DOES(Serialize##State, (void *c, void *state, FMI(Byte) bytes[], size_t size), \
         if (size < sizeof *x) { wrong = "the state is larger"; } \
         else { (void)memcpy(bytes, state, sizeof *x); }) \
    DOES(Deserialize, (void *c, const FMI(Byte) bytes[], size_t size, void **state), \
         instance *copy = *state == NULL ? malloc(sizeof *x) : *state; \
         if (copy == NULL || size != sizeof *x) { wrong = "no state of this FMU"; } \
         else { (void)memcpy(copy, bytes, sizeof *x); *state = copy; })

static void take_up(instance *x, const instance *copy) {
    (void)memcpy(x->numbers, copy->numbers, sizeof x->numbers);
    x->state = copy->state;
    model_moved(&x->state);
}

#include "fmi{{ version }}.h"

const char *FMI(GetVersion)(void) { return FMI(Version); }
void FMI(FreeInstance)(void *c) { free(c); }
DOES(Reset, ALONE, memcpy(x->numbers, first_numbers, sizeof first_numbers);
     model_step(&x->state, x->numbers, true))
DOES(ExitInitializationMode, ALONE, model_step(&x->state, x->numbers, true))
DOES(Terminate, ALONE, )
DOES(SetDebugLogging, (void *c, FMI(Boolean) on, size_t n, const FMI(String) of[]), )
