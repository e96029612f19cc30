/* What FMI 2 and 3 have alike; the functions of a version are then rows of a table.
 *
 * FMI(name) is a name in the version, HANDLE what an instance is there; LOGGER the type of what
 * TELL(x, wrong) tells an error to.
 */
#include "fmu.h"

typedef struct {
    fmu fmu; /* first, so that a pointer to this is one to it */
    LOGGER log;
    void *host;
} instance;

static FMI(Status) ended(const instance *x, const char *wrong) {
    if (wrong != NULL && x->log != NULL) {
        TELL(x, wrong);
    }
    return wrong == NULL ? FMI(OK) : FMI(Error);
}

static instance *made(const char *token, LOGGER log, void *host) {
    instance *x = token != NULL && strcmp(token, FMU_TOKEN) == 0 ? calloc(1, sizeof *x) : NULL;
    if (x != NULL) {
        x->log = log;
        x->host = host;
        reset(&x->fmu);
    }
    return x;
}

#define SOME HANDLE c, const FMI(ValueReference) at[], size_t count
#define DOES(name, parameters, wrong) \
    FMI(Status) FMI(name) parameters { return ended(c, wrong); }
#define DOES_NOTHING(name, parameters) DOES(name, parameters, NULL)
#define CANNOT(name, parameters) DOES(name, parameters, "this function is not offered")
#define HAS_NO(name, parameters) DOES(name, parameters, count > 0U ? "no such variable" : NULL)

const char *FMI(GetVersion)(void) { return FMI(Version); }

void FMI(FreeInstance)(HANDLE c) { free(c); }

DOES(Reset, (HANDLE c), reset(c))
DOES(ExitInitializationMode, (HANDLE c), start(c))
DOES_NOTHING(Terminate, (HANDLE c))
DOES_NOTHING(SetDebugLogging, (HANDLE c, FMI(Boolean) on, size_t n, const FMI(String) x[]))
