/* FMI 2.0 for co-simulation. The headers of FMI come with the tool that compiles this. */
#include <fmi2Functions.h>

#define FMI(name) fmi2##name
#define HANDLE fmi2Component
#define LOGGER fmi2CallbackLogger
#define TELL(x, wrong) (x)->log((x)->host, FMU_NAME, fmi2Error, "logStatusError", wrong)
#include "fmi.h"

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *host, fmi2Boolean visible,
                              fmi2Boolean logs) {
    const char *token = type == fmi2CoSimulation ? guid : NULL;
    return made(token, host->logger, host->componentEnvironment);
}

DOES(SetupExperiment, (HANDLE c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real begin,
                       fmi2Boolean ends, fmi2Real end), begin_at(c, begin))
DOES_NOTHING(EnterInitializationMode, (HANDLE c))
DOES(GetReal, (SOME, fmi2Real values[]), get_reals(c, at, count, values))
DOES(GetInteger, (SOME, fmi2Integer values[]), get_reason(c, at, count, values))
DOES(SetReal, (SOME, const fmi2Real values[]), set_reals(c, at, count, values))
DOES(DoStep, (HANDLE c, fmi2Real time, fmi2Real length, fmi2Boolean forgets),
     advance(c, time, length))

HAS_NO(GetBoolean, (SOME, fmi2Boolean values[]))
HAS_NO(GetString, (SOME, fmi2String values[]))
HAS_NO(SetInteger, (SOME, const fmi2Integer values[]))
HAS_NO(SetBoolean, (SOME, const fmi2Boolean values[]))
HAS_NO(SetString, (SOME, const fmi2String values[]))

CANNOT(GetFMUstate, (HANDLE c, fmi2FMUstate *state))
CANNOT(SetFMUstate, (HANDLE c, fmi2FMUstate state))
CANNOT(FreeFMUstate, (HANDLE c, fmi2FMUstate *state))
CANNOT(SerializedFMUstateSize, (HANDLE c, fmi2FMUstate state, size_t *size))
CANNOT(SerializeFMUstate, (HANDLE c, fmi2FMUstate state, fmi2Byte bytes[], size_t size))
CANNOT(DeSerializeFMUstate,
       (HANDLE c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state))
CANNOT(GetDirectionalDerivative, (SOME, const fmi2ValueReference known[], size_t knowns,
                                      const fmi2Real by[], fmi2Real values[]))
CANNOT(SetRealInputDerivatives, (SOME, const fmi2Integer order[], const fmi2Real values[]))
CANNOT(GetRealOutputDerivatives, (SOME, const fmi2Integer order[], fmi2Real values[]))
CANNOT(CancelStep, (HANDLE c))
CANNOT(GetStatus, (HANDLE c, const fmi2StatusKind of, fmi2Status *value))
CANNOT(GetRealStatus, (HANDLE c, const fmi2StatusKind of, fmi2Real *value))
CANNOT(GetIntegerStatus, (HANDLE c, const fmi2StatusKind of, fmi2Integer *value))
CANNOT(GetBooleanStatus, (HANDLE c, const fmi2StatusKind of, fmi2Boolean *value))
CANNOT(GetStringStatus, (HANDLE c, const fmi2StatusKind of, fmi2String *value))
