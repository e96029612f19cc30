/* FMI 3.0 for co-simulation. The headers of FMI come with the tool that compiles this. */
#include <fmi3Functions.h>

#define FMI(name) fmi3##name
#define HANDLE fmi3Instance
#define LOGGER fmi3LogMessageCallback
#define TELL(x, wrong) (x)->log((x)->host, fmi3Error, "logStatusError", wrong)
#include "fmi.h"

#define ONE_EACH(wrong) \
    (count == n ? (wrong) : "there are not as many values as value references")

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logs,
    fmi3Boolean has_events, fmi3Boolean may_return_early, const fmi3ValueReference between[],
    size_t count, fmi3InstanceEnvironment host, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    return made(token, log, host);
}

DOES(EnterInitializationMode, (HANDLE c, fmi3Boolean tolerant, fmi3Float64 tolerance,
                               fmi3Float64 begin, fmi3Boolean ends, fmi3Float64 end),
     begin_at(c, begin))
DOES(GetFloat64, (SOME, fmi3Float64 values[], size_t n), ONE_EACH(get_reals(c, at, count, values)))
DOES(GetInt32, (SOME, fmi3Int32 values[], size_t n), ONE_EACH(get_reason(c, at, count, values)))
DOES(SetFloat64, (SOME, const fmi3Float64 values[], size_t n),
     ONE_EACH(set_reals(c, at, count, values)))

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 length, fmi3Boolean forgets,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                      fmi3Float64 *reached) {
    const char *wrong = advance(c, time, length);
    *event = *terminate = *early = fmi3False;
    *reached = wrong ? time : time + length;
    return ended(c, wrong);
}

#define HAS_NONE_OF(type) \
    HAS_NO(Get##type, (SOME, fmi3##type values[], size_t n)) \
    HAS_NO(Set##type, (SOME, const fmi3##type values[], size_t n))

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
HAS_NO(SetInt32, (SOME, const fmi3Int32 values[], size_t n))
HAS_NO(GetBinary, (SOME, size_t sizes[], fmi3Binary values[], size_t n))
HAS_NO(SetBinary, (SOME, const size_t sizes[], const fmi3Binary values[], size_t n))
HAS_NO(GetClock, (SOME, fmi3Clock values[]))
HAS_NO(SetClock, (SOME, const fmi3Clock values[]))
HAS_NO(GetIntervalDecimal, (SOME, fmi3Float64 values[], fmi3IntervalQualifier kinds[]))
HAS_NO(GetIntervalFraction,
       (SOME, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier kinds[]))
HAS_NO(GetShiftDecimal, (SOME, fmi3Float64 values[]))
HAS_NO(GetShiftFraction, (SOME, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
HAS_NO(SetIntervalDecimal, (SOME, const fmi3Float64 values[]))
HAS_NO(SetIntervalFraction,
       (SOME, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
HAS_NO(SetShiftDecimal, (SOME, const fmi3Float64 values[]))
HAS_NO(SetShiftFraction, (SOME, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))

CANNOT(EnterEventMode, (HANDLE c))
CANNOT(EnterStepMode, (HANDLE c))
CANNOT(EnterConfigurationMode, (HANDLE c))
CANNOT(ExitConfigurationMode, (HANDLE c))
CANNOT(EvaluateDiscreteStates, (HANDLE c))
CANNOT(UpdateDiscreteStates,
       (HANDLE c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
        fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *time))
CANNOT(GetNumberOfVariableDependencies, (HANDLE c, fmi3ValueReference of, size_t *n))
CANNOT(GetVariableDependencies,
       (HANDLE c, fmi3ValueReference of, size_t elements[], fmi3ValueReference on[],
        size_t their_elements[], fmi3DependencyKind kinds[], size_t n))
CANNOT(GetFMUState, (HANDLE c, fmi3FMUState *state))
CANNOT(SetFMUState, (HANDLE c, fmi3FMUState state))
CANNOT(FreeFMUState, (HANDLE c, fmi3FMUState *state))
CANNOT(SerializedFMUStateSize, (HANDLE c, fmi3FMUState state, size_t *size))
CANNOT(SerializeFMUState, (HANDLE c, fmi3FMUState state, fmi3Byte bytes[], size_t size))
CANNOT(DeserializeFMUState,
       (HANDLE c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state))
CANNOT(GetDirectionalDerivative,
       (SOME, const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
        size_t seeds, fmi3Float64 values[], size_t n))
CANNOT(GetAdjointDerivative,
       (SOME, const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
        size_t seeds, fmi3Float64 values[], size_t n))
CANNOT(GetOutputDerivatives, (SOME, const fmi3Int32 orders[], fmi3Float64 values[], size_t n))

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

CANNOT(EnterContinuousTimeMode, (HANDLE c))
CANNOT(CompletedIntegratorStep,
       (HANDLE c, fmi3Boolean forgets, fmi3Boolean *event, fmi3Boolean *terminate))
CANNOT(SetTime, (HANDLE c, fmi3Float64 time))
CANNOT(SetContinuousStates, (HANDLE c, const fmi3Float64 x[], size_t n))
CANNOT(GetContinuousStateDerivatives, (HANDLE c, fmi3Float64 x[], size_t n))
CANNOT(GetEventIndicators, (HANDLE c, fmi3Float64 x[], size_t n))
CANNOT(GetContinuousStates, (HANDLE c, fmi3Float64 x[], size_t n))
CANNOT(GetNominalsOfContinuousStates, (HANDLE c, fmi3Float64 x[], size_t n))
CANNOT(GetNumberOfEventIndicators, (HANDLE c, size_t *n))
CANNOT(GetNumberOfContinuousStates, (HANDLE c, size_t *n))
CANNOT(ActivateModelPartition, (HANDLE c, fmi3ValueReference at, fmi3Float64 time))
