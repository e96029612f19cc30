/* The functions of FMI 3.0; tools look for all of them. */
#define VALUES(type) (SOME, type values[], size_t n)
#define TELL(wrong) ((fmi3LogMessageCallback)x->log)(x->host, fmi3Error, "logStatusError", wrong)
#define CALLED fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logs
#define HOST void *host, fmi3LogMessageCallback log
void *fmi3InstantiateCoSimulation(CALLED, bool events, bool early, const uint32_t between[],
                                  size_t count, HOST, fmi3IntermediateUpdateCallback update) {
    return new_instance(token, (void (*)(void))log, host);
}
void *fmi3InstantiateModelExchange(CALLED, HOST) { return NULL; }
void *fmi3InstantiateScheduledExecution(CALLED, HOST, fmi3ClockUpdateCallback update,
                                        fmi3LockPreemptionCallback lock,
                                        fmi3UnlockPreemptionCallback unlock) { return NULL; }
BEGINS(EnterInitializationMode)
DOES(DoStep, (void *c, double time, double length, bool forgets, bool *event, bool *end,
              bool *early, double *reached),
     wrong = advance(x, time, length); *event = *end = *early = false; *reached = x->numbers[TIME])

GET(Float64, n == count && at[i] < REASON) SET(Float64, n == count && at[i] < GIVEN)
GET(Int32, n == count && at[i] == REASON) SET(Int32, false)
HAS_NO(Float32) HAS_NO(Int8) HAS_NO(UInt8) HAS_NO(Int16) HAS_NO(UInt16) HAS_NO(UInt32)
HAS_NO(Int64) HAS_NO(UInt64) HAS_NO(Boolean) HAS_NO(String)
EACH(GetBinary, (SOME, size_t sizes[], fmi3Binary values[], size_t n), false, )
EACH(SetBinary, (SOME, const size_t sizes[], const fmi3Binary values[], size_t n), false, )
EACH(GetClock, (SOME, bool values[]), false, )
EACH(SetClock, (SOME, const bool values[]), false, )

#define CANNOT_TIME(name, kind) \
    CANNOT(name##Decimal, (SOME, kind double values[])) \
    CANNOT(name##Fraction, (SOME, kind uint64_t counts[], kind uint64_t over[]))
CANNOT_TIME(GetShift, ) CANNOT_TIME(SetShift, const) CANNOT_TIME(SetInterval, const)
CANNOT(GetIntervalDecimal, (SOME, double values[], fmi3IntervalQualifier of[]))
CANNOT(GetIntervalFraction, (SOME, uint64_t counts[], uint64_t over[], fmi3IntervalQualifier of[]))

KEEPS(FMUState, DeserializeFMUState)
CANNOT(EnterEventMode, ALONE) CANNOT(EnterStepMode, ALONE) CANNOT(EnterConfigurationMode, ALONE)
CANNOT(ExitConfigurationMode, ALONE) CANNOT(EnterContinuousTimeMode, ALONE)
CANNOT(EvaluateDiscreteStates, ALONE) CANNOT(SetTime, AND(double))
CANNOT(ActivateModelPartition, (void *c, uint32_t clock, double time))
CANNOT(CompletedIntegratorStep, (void *c, bool forgets, bool *event, bool *end))
CANNOT(UpdateDiscreteStates, (void *c, bool *again, bool *end, bool *nominals, bool *values,
                              bool *defined, double *time))
#define NUMBERS(kind) (void *c, kind double values[], size_t n)
CANNOT(GetContinuousStates, NUMBERS()) CANNOT(SetContinuousStates, NUMBERS(const))
CANNOT(GetContinuousStateDerivatives, NUMBERS()) CANNOT(GetEventIndicators, NUMBERS())
CANNOT(GetNominalsOfContinuousStates, NUMBERS())
CANNOT(GetNumberOfContinuousStates, AND(size_t *)) CANNOT(GetNumberOfEventIndicators, AND(size_t *))
CANNOT(GetNumberOfVariableDependencies, (void *c, uint32_t of, size_t *n))
CANNOT(GetVariableDependencies, (void *c, uint32_t of, size_t elements[], uint32_t on[],
                                 size_t their_elements[], fmi3DependencyKind kinds[], size_t n))
CANNOT(GetOutputDerivatives, (SOME, const int32_t orders[], double values[], size_t n))
CANNOT(GetDirectionalDerivative, (BY, size_t seeds, double values[], size_t n))
CANNOT(GetAdjointDerivative, (BY, size_t seeds, double values[], size_t n))
