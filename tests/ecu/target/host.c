/* Answers to samples that come from the standard input; as its argument tells, so many. */
#include <stdio.h>
#include <stdlib.h>

#include "bte_run.h"

int main(int arguments, char **argument) {
    const size_t count = arguments == 2 ? (size_t)strtoul(argument[1], NULL, 10) : 0U;
    bte_real *samples = malloc(count * BTE_INPUTS * sizeof *samples);
    bte_real *answers = malloc(count * BTE_OUTPUTS * sizeof *answers);
    size_t done = 0;
    if (samples != NULL && answers != NULL
        && fread(samples, sizeof *samples * BTE_INPUTS, count, stdin) == count) {
        bte_run(samples, (uint32_t)count, answers);
        done = fwrite(answers, sizeof *answers * BTE_OUTPUTS, count, stdout);
    }
    free(samples);
    free(answers);
    return done == count && count > 0U ? EXIT_SUCCESS : EXIT_FAILURE;
}
