/* The functions of FMI 2.0, by the macros of fmi.c. */
#define VALUES(type) (SOME, type values[])
#define TELL(wrong) \
    ((fmi2CallbackLogger)x->log)(x->host, "{{ name }}", fmi2Error, "logStatusError", wrong)

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
void *fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                      const fmi2CallbackFunctions *host, int visible, int logs) {
    void (*log)(void) = (void (*)(void))host->logger;
    return type == fmi2CoSimulation ? new_instance(guid, log, host->componentEnvironment) : NULL;
}
SET_TIME(SetupExperiment)
FUNCTION(EnterInitializationMode, ONLY, )
FUNCTION(DoStep, (void *c, double time, double length, int forgets),
         wrong = advance(x, time, length))

GET(Real, at[i] < REASON) SET(Real, at[i] < GIVEN)
GET(Integer, at[i] == REASON) SET(Integer, false)
NONE_OF(Boolean) NONE_OF(String)

STATES(FMUstate, DeSerializeFMUstate)
ABSENT(GetDirectionalDerivative, (SEEDS, double values[]))
ABSENT(SetRealInputDerivatives, (SOME, const int order[], const double values[]))
ABSENT(GetRealOutputDerivatives, (SOME, const int order[], double values[]))
#define STATUS(type) (void *c, const fmi2StatusKind of, type *value)
ABSENT(GetStatus, STATUS(fmi2Status)) ABSENT(GetStringStatus, STATUS(fmi2String))
ABSENT(GetRealStatus, STATUS(double)) ABSENT(GetIntegerStatus, STATUS(int))
ABSENT(GetBooleanStatus, STATUS(int)) ABSENT(CancelStep, ONLY)
