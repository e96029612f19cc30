/* FMI 2.0 for co-simulation. The headers of FMI come with the tool that compiles this. */
#include <fmi2Functions.h>

#include "fmu.h"

typedef struct {
    fmu fmu; /* first, so that a pointer to this is one to it */
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment host;
} instance;

static fmi2Status ended(const instance *x, const char *wrong) {
    if (wrong != NULL && x->log != NULL) {
        x->log(x->host, FMU_NAME, fmi2Error, "logStatusError", wrong);
    }
    return wrong == NULL ? fmi2OK : fmi2Error;
}

#define SOME fmi2Component c, const fmi2ValueReference at[], size_t count
#define DOES_NOTHING(name, parameters) \
    fmi2Status name parameters { return fmi2OK; }
#define CANNOT(name, parameters) \
    fmi2Status name parameters { return ended(c, "this function is not offered"); }
#define HAS_NO(name, type) \
    fmi2Status name(SOME, type of[]) { return ended(c, count > 0U ? "no such variable" : NULL); }

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *host, fmi2Boolean visible,
                              fmi2Boolean logs) {
    const int fits = type == fmi2CoSimulation && guid != NULL && strcmp(guid, FMU_TOKEN) == 0;
    instance *x = fits ? calloc(1, sizeof *x) : NULL;
    if (x != NULL) {
        x->log = host->logger;
        x->host = host->componentEnvironment;
        reset(&x->fmu);
    }
    return x;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance,
                               fmi2Real begin, fmi2Boolean ends, fmi2Real end) {
    ((fmu *)c)->time = begin;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    start(c);
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    reset(c);
    return fmi2OK;
}

fmi2Status fmi2GetReal(SOME, fmi2Real values[]) {
    return ended(c, get_reals(c, at, count, values));
}

fmi2Status fmi2GetInteger(SOME, fmi2Integer values[]) {
    return ended(c, get_reason(c, at, count, values));
}

fmi2Status fmi2SetReal(SOME, const fmi2Real values[]) {
    return ended(c, set_reals(c, at, count, values));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean forgets) {
    return ended(c, advance(c, time, length));
}

DOES_NOTHING(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String x[]))
DOES_NOTHING(fmi2EnterInitializationMode, (fmi2Component c))
DOES_NOTHING(fmi2Terminate, (fmi2Component c))

HAS_NO(fmi2GetBoolean, fmi2Boolean)
HAS_NO(fmi2GetString, fmi2String)
HAS_NO(fmi2SetInteger, const fmi2Integer)
HAS_NO(fmi2SetBoolean, const fmi2Boolean)
HAS_NO(fmi2SetString, const fmi2String)

CANNOT(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *state))
CANNOT(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate state))
CANNOT(fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *state))
CANNOT(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size))
CANNOT(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size))
CANNOT(fmi2DeSerializeFMUstate,
       (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state))
CANNOT(fmi2GetDirectionalDerivative, (SOME, const fmi2ValueReference known[], size_t knowns,
                                      const fmi2Real by[], fmi2Real values[]))
CANNOT(fmi2SetRealInputDerivatives, (SOME, const fmi2Integer order[], const fmi2Real values[]))
CANNOT(fmi2GetRealOutputDerivatives, (SOME, const fmi2Integer order[], fmi2Real values[]))
CANNOT(fmi2CancelStep, (fmi2Component c))
CANNOT(fmi2GetStatus, (fmi2Component c, const fmi2StatusKind of, fmi2Status *value))
CANNOT(fmi2GetRealStatus, (fmi2Component c, const fmi2StatusKind of, fmi2Real *value))
CANNOT(fmi2GetIntegerStatus, (fmi2Component c, const fmi2StatusKind of, fmi2Integer *value))
CANNOT(fmi2GetBooleanStatus, (fmi2Component c, const fmi2StatusKind of, fmi2Boolean *value))
CANNOT(fmi2GetStringStatus, (fmi2Component c, const fmi2StatusKind of, fmi2String *value))
