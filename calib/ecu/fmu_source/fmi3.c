/* FMI 3.0 for co-simulation. The headers of FMI come with the tool that compiles this. */
#include <fmi3Functions.h>

#include "fmu.h"

typedef struct {
    fmu fmu; /* first, so that a pointer to this is one to it */
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment host;
} instance;

static fmi3Status ended(const instance *x, const char *wrong) {
    if (wrong != NULL && x->log != NULL) {
        x->log(x->host, fmi3Error, "logStatusError", wrong);
    }
    return wrong == NULL ? fmi3OK : fmi3Error;
}

static const char *one_each(size_t references, size_t values) {
    return references == values ? NULL : "there are not as many values as value references";
}

#define SOME fmi3Instance c, const fmi3ValueReference at[], size_t count
#define DOES_NOTHING(name, parameters) \
    fmi3Status name parameters { return fmi3OK; }
#define CANNOT(name, parameters) \
    fmi3Status name parameters { return ended(c, "this function is not offered"); }
#define HAS_NO(name, parameters) \
    fmi3Status name parameters { return ended(c, count > 0U ? "no such variable" : NULL); }

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logs,
    fmi3Boolean has_events, fmi3Boolean may_return_early, const fmi3ValueReference between[],
    size_t count, fmi3InstanceEnvironment host, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    instance *x = token != NULL && strcmp(token, FMU_TOKEN) == 0 ? calloc(1, sizeof *x) : NULL;
    if (x != NULL) {
        x->log = log;
        x->host = host;
        reset(&x->fmu);
    }
    return x;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerant, fmi3Float64 tolerance,
                                       fmi3Float64 begin, fmi3Boolean ends, fmi3Float64 end) {
    ((fmu *)c)->time = begin;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    start(c);
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
    reset(c);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(SOME, fmi3Float64 values[], size_t n) {
    const char *wrong = one_each(count, n);
    return ended(c, wrong ? wrong : get_reals(c, at, count, values));
}

fmi3Status fmi3GetInt32(SOME, fmi3Int32 values[], size_t n) {
    const char *wrong = one_each(count, n);
    return ended(c, wrong ? wrong : get_reason(c, at, count, values));
}

fmi3Status fmi3SetFloat64(SOME, const fmi3Float64 values[], size_t n) {
    const char *wrong = one_each(count, n);
    return ended(c, wrong ? wrong : set_reals(c, at, count, values));
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 length, fmi3Boolean forgets,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                      fmi3Float64 *reached) {
    const char *wrong = advance(c, time, length);
    *event = *terminate = *early = fmi3False;
    *reached = wrong ? time : time + length;
    return ended(c, wrong);
}

DOES_NOTHING(fmi3SetDebugLogging, (fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String x[]))
DOES_NOTHING(fmi3Terminate, (fmi3Instance c))

#define HAS_NONE_OF(type) \
    HAS_NO(fmi3Get##type, (SOME, fmi3##type values[], size_t n)) \
    HAS_NO(fmi3Set##type, (SOME, const fmi3##type values[], size_t n))

HAS_NONE_OF(Float32)
HAS_NONE_OF(Int8)
HAS_NONE_OF(UInt8)
HAS_NONE_OF(Int16)
HAS_NONE_OF(UInt16)
HAS_NONE_OF(UInt32)
HAS_NONE_OF(Int64)
HAS_NONE_OF(UInt64)
HAS_NONE_OF(Boolean)
HAS_NONE_OF(String)
HAS_NO(fmi3SetInt32, (SOME, const fmi3Int32 values[], size_t n))
HAS_NO(fmi3GetBinary, (SOME, size_t sizes[], fmi3Binary values[], size_t n))
HAS_NO(fmi3SetBinary, (SOME, const size_t sizes[], const fmi3Binary values[], size_t n))
HAS_NO(fmi3GetClock, (SOME, fmi3Clock values[]))
HAS_NO(fmi3SetClock, (SOME, const fmi3Clock values[]))
HAS_NO(fmi3GetIntervalDecimal, (SOME, fmi3Float64 values[], fmi3IntervalQualifier kinds[]))
HAS_NO(fmi3GetIntervalFraction,
       (SOME, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier kinds[]))
HAS_NO(fmi3GetShiftDecimal, (SOME, fmi3Float64 values[]))
HAS_NO(fmi3GetShiftFraction, (SOME, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
HAS_NO(fmi3SetIntervalDecimal, (SOME, const fmi3Float64 values[]))
HAS_NO(fmi3SetIntervalFraction,
       (SOME, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
HAS_NO(fmi3SetShiftDecimal, (SOME, const fmi3Float64 values[]))
HAS_NO(fmi3SetShiftFraction, (SOME, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))

CANNOT(fmi3EnterEventMode, (fmi3Instance c))
CANNOT(fmi3EnterStepMode, (fmi3Instance c))
CANNOT(fmi3EnterConfigurationMode, (fmi3Instance c))
CANNOT(fmi3ExitConfigurationMode, (fmi3Instance c))
CANNOT(fmi3EvaluateDiscreteStates, (fmi3Instance c))
CANNOT(fmi3UpdateDiscreteStates,
       (fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
        fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *time))
CANNOT(fmi3GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference of, size_t *n))
CANNOT(fmi3GetVariableDependencies,
       (fmi3Instance c, fmi3ValueReference of, size_t elements[], fmi3ValueReference on[],
        size_t their_elements[], fmi3DependencyKind kinds[], size_t n))
CANNOT(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *state))
CANNOT(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState state))
CANNOT(fmi3FreeFMUState, (fmi3Instance c, fmi3FMUState *state))
CANNOT(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState state, size_t *size))
CANNOT(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size))
CANNOT(fmi3DeserializeFMUState,
       (fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state))
CANNOT(fmi3GetDirectionalDerivative,
       (SOME, const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
        size_t seeds, fmi3Float64 values[], size_t n))
CANNOT(fmi3GetAdjointDerivative,
       (SOME, const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
        size_t seeds, fmi3Float64 values[], size_t n))
CANNOT(fmi3GetOutputDerivatives, (SOME, const fmi3Int32 orders[], fmi3Float64 values[], size_t n))

/* Of model exchange and scheduled execution; tools look for all functions of the standard. */
fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logs,
    fmi3InstanceEnvironment host, fmi3LogMessageCallback log) {
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logs,
    fmi3InstanceEnvironment host, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    return NULL;
}

CANNOT(fmi3EnterContinuousTimeMode, (fmi3Instance c))
CANNOT(fmi3CompletedIntegratorStep,
       (fmi3Instance c, fmi3Boolean forgets, fmi3Boolean *event, fmi3Boolean *terminate))
CANNOT(fmi3SetTime, (fmi3Instance c, fmi3Float64 time))
CANNOT(fmi3SetContinuousStates, (fmi3Instance c, const fmi3Float64 x[], size_t n))
CANNOT(fmi3GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 x[], size_t n))
CANNOT(fmi3GetEventIndicators, (fmi3Instance c, fmi3Float64 x[], size_t n))
CANNOT(fmi3GetContinuousStates, (fmi3Instance c, fmi3Float64 x[], size_t n))
CANNOT(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 x[], size_t n))
CANNOT(fmi3GetNumberOfEventIndicators, (fmi3Instance c, size_t *n))
CANNOT(fmi3GetNumberOfContinuousStates, (fmi3Instance c, size_t *n))
CANNOT(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference at, fmi3Float64 time))
