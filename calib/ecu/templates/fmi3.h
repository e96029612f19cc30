/* The functions of FMI 3.0, by the macros of fmi.c; tools look for all of them. */
#define VALUES(type) (SOME, type values[], size_t n)
#define TELL(wrong) ((fmi3LogMessageCallback)x->log)(x->host, fmi3Error, "logStatusError", wrong)
#define NAMED fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logs
#define HOST void *host, fmi3LogMessageCallback log
void *fmi3InstantiateCoSimulation(NAMED, bool events, bool early, const uint32_t between[],
                                  size_t count, HOST, fmi3IntermediateUpdateCallback update) {
    return new_instance(token, (void (*)(void))log, host);
}
void *fmi3InstantiateModelExchange(NAMED, HOST) { return NULL; }
void *fmi3InstantiateScheduledExecution(NAMED, HOST, fmi3ClockUpdateCallback update,
                                        fmi3LockPreemptionCallback lock,
                                        fmi3UnlockPreemptionCallback unlock) { return NULL; }
SET_TIME(EnterInitializationMode)
FUNCTION(DoStep, (void *c, double time, double length, bool forgets, bool *event, bool *end,
              bool *early, double *reached),
     wrong = advance(x, time, length); *event = *end = *early = false; *reached = x->numbers[TIME])

GET(Float64, n == count && at[i] < REASON) SET(Float64, n == count && at[i] < GIVEN)
GET(Int32, n == count && at[i] == REASON) SET(Int32, false)
NONE_OF(Float32) NONE_OF(Int8) NONE_OF(UInt8) NONE_OF(Int16) NONE_OF(UInt16) NONE_OF(UInt32)
NONE_OF(Int64) NONE_OF(UInt64) NONE_OF(Boolean) NONE_OF(String)
FOR_EACH(GetBinary, (SOME, size_t sizes[], fmi3Binary values[], size_t n), false, )
FOR_EACH(SetBinary, (SOME, const size_t sizes[], const fmi3Binary values[], size_t n), false, )
FOR_EACH(GetClock, (SOME, bool values[]), false, )
FOR_EACH(SetClock, (SOME, const bool values[]), false, )

#define ABSENT_TIMES(name, kind) \
    ABSENT(name##Decimal, (SOME, kind double values[])) \
    ABSENT(name##Fraction, (SOME, kind uint64_t counts[], kind uint64_t over[]))
ABSENT_TIMES(GetShift, ) ABSENT_TIMES(SetShift, const) ABSENT_TIMES(SetInterval, const)
ABSENT(GetIntervalDecimal, (SOME, double values[], fmi3IntervalQualifier of[]))
ABSENT(GetIntervalFraction, (SOME, uint64_t counts[], uint64_t over[], fmi3IntervalQualifier of[]))

STATES(FMUState, DeserializeFMUState)
ABSENT(EnterEventMode, ONLY) ABSENT(EnterStepMode, ONLY) ABSENT(EnterConfigurationMode, ONLY)
ABSENT(ExitConfigurationMode, ONLY) ABSENT(EnterContinuousTimeMode, ONLY)
ABSENT(EvaluateDiscreteStates, ONLY) ABSENT(SetTime, WITH(double))
ABSENT(ActivateModelPartition, (void *c, uint32_t clock, double time))
ABSENT(CompletedIntegratorStep, (void *c, bool forgets, bool *event, bool *end))
ABSENT(UpdateDiscreteStates, (void *c, bool *again, bool *end, bool *nominals, bool *values,
                              bool *defined, double *time))
#define NUMBERS(kind) (void *c, kind double values[], size_t n)
ABSENT(GetContinuousStates, NUMBERS()) ABSENT(SetContinuousStates, NUMBERS(const))
ABSENT(GetContinuousStateDerivatives, NUMBERS()) ABSENT(GetEventIndicators, NUMBERS())
ABSENT(GetNominalsOfContinuousStates, NUMBERS())
ABSENT(GetNumberOfContinuousStates, WITH(size_t *))
ABSENT(GetNumberOfEventIndicators, WITH(size_t *))
ABSENT(GetNumberOfVariableDependencies, (void *c, uint32_t of, size_t *n))
ABSENT(GetVariableDependencies, (void *c, uint32_t of, size_t elements[], uint32_t on[],
                                 size_t their_elements[], fmi3DependencyKind kinds[], size_t n))
ABSENT(GetOutputDerivatives, (SOME, const int32_t orders[], double values[], size_t n))
ABSENT(GetDirectionalDerivative, (SEEDS, size_t seeds, double values[], size_t n))
ABSENT(GetAdjointDerivative, (SEEDS, size_t seeds, double values[], size_t n))
