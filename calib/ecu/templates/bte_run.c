/* Run the estimator of brake-cal over many samples, for tests: the function bte_run.
 *
 * With BTE_VECTORS defined this file is a program for a PC. Without an argument it compares its
 * answers with those of Python in bte_vectors.h. `bte_run stop.csv > answers.csv` prints its answers
 * to a stop that `brake-cal log STOP --si --out stop.csv` wrote.
 */
#include "bte.h"

typedef struct {
    bte_real reason;
    bte_answers answers;
} bte_row;

enum { BTE_ROW = (int)(sizeof(bte_row) / sizeof(bte_real)) }; /* numbers of a row */

/* Begin anew, and answer `count` samples. */
void bte_run(const bte_car *car, const bte_inputs samples[], uint32_t count, bte_row rows[]) {
    static bte_state state;
    (void)bte_init(&state, car);
    for (uint32_t i = 0; i < count; i++) {
        rows[i].reason = (bte_real)bte_step(&state, &samples[i]);
        rows[i].answers = state.answers;
    }
}

#ifdef BTE_VECTORS
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bte_vectors.h"

enum { LINE = 65536, CELLS = 1024, REFUSED = 2 }; /* most in a line of a file; exit code */

/* Compare the answers at the ends of the blocks with those of Python; 1 if they differ. */
static int compare(void) {
    static bte_row rows[BTE_VECTORS_COUNT];
    unsigned wrong = 0U;
    double worst = 0.0;
    bte_run(BTE_VECTORS_CAR, bte_vectors_inputs, BTE_VECTORS_COUNT, rows);
    for (uint32_t i = 0; i < BTE_VECTORS_COUNT / BTE_VECTORS_EVERY; i++) {
        const bte_real *row = (const bte_real *)&rows[(i + 1U) * BTE_VECTORS_EVERY - 1U];
        for (unsigned k = 0; k < BTE_ROW; k++) {
            const double right = (double)bte_vectors_answers[i][k];
            const double apart = fabs((double)row[k] - right) / fmax(right, 1e-6);
            wrong += !(apart <= BTE_VECTORS_TOLERANCE);
            worst = fmax(worst, apart);
        }
    }
    printf("%u samples: largest difference %.3g, %u beyond %g\n", BTE_VECTORS_COUNT, worst, wrong,
           BTE_VECTORS_TOLERANCE);
    return wrong > 0U;
}

static int refuse(const char *file, const char *wrong, const char *name) {
    fprintf(stderr, "%s: %s%s; write it with `brake-cal log STOP --si --out stop.csv`\n", file,
            wrong, name);
    return REFUSED;
}

/* Split a line at its commas, and return the number of cells. */
static int split(char *line, char *cell[CELLS]) {
    int count = 0;
    line[strcspn(line, "\r\n")] = '\0';
    for (char *next = line; next != NULL && count < CELLS; count++) {
        cell[count] = next;
        next = strchr(next, ',');
        if (next != NULL) {
            *next++ = '\0';
        }
    }
    return count;
}

/* Return the place of a column by its name and unit; -1 without one, -2 with another unit. */
static int place_of(char *const cell[], int count, const char *column) {
    const size_t name = strcspn(column, " ");
    for (int k = 0; k < count; k++) {
        if (strncmp(cell[k], column, name) == 0 && strchr(" [", cell[k][name]) != NULL) {
            return strcmp(cell[k], column) == 0 ? k : -2;
        }
    }
    return -1;
}

/* Print the answers to the samples of a file. In a gap of the file all sensors fail. */
static int run_file(const char *path) {
    static char line[LINE];
    static bte_state state;
    static bte_inputs sample, gap;
    bte_real *x = (bte_real *)&sample, *missing = (bte_real *)&gap;
    const bte_real *answers = (const bte_real *)&state.answers;
    char *cell[CELLS];
    int place[BTE_INPUTS];
    const double step = (double)BTE_VECTORS_CAR->numbers->sample_time;
    double last = -1.0;
    FILE *file = fopen(path, "r");
    if (file == NULL || fgets(line, LINE, file) == NULL) {
        return refuse(path, "cannot be read", "");
    }
    const int columns = split(line, cell), time_place = place_of(cell, columns, "time [s]");
    if (time_place < 0) {
        return refuse(path, "no column time [s]", "");
    }
    for (int i = 0; i < BTE_INPUTS; i++) {
        missing[i] = (bte_real)NAN;
        place[i] = place_of(cell, columns, bte_vectors_columns[i]);
        if (place[i] == -2 || (place[i] < 0 && i < BTE_VECTORS_NEEDED)) {
            return refuse(path, "no column ", bte_vectors_columns[i]);
        }
    }
    printf("%s\n", bte_vectors_header);
    (void)bte_init(&state, BTE_VECTORS_CAR);
    for (unsigned rows = 0; fgets(line, LINE, file) != NULL; rows++) {
        const int count = split(line, cell);
        const double time = time_place < count ? strtod(cell[time_place], NULL) : -1.0;
        const double steps = rows == 0U ? 1.0 : (time - last) / step;
        /* the first step must be that of the code; a later one may be a gap */
        if (!(steps > 0.75 && (rows > 1U || steps < 1.25))) {
            return refuse(path, "its rate is not the `sample_time` of the code", "");
        }
        const double most = 10.0 / step; /* of a longer gap only 10 s are run */
        for (double k = 1.0; k < fmin(floor(steps + 0.5), most); k += 1.0) {
            (void)bte_step(&state, &gap);
        }
        for (int i = 0; i < BTE_INPUTS; i++) {
            const char *text = place[i] >= 0 && place[i] < count ? cell[place[i]] : "0";
            x[i] = *text == '\0' ? (bte_real)NAN : (bte_real)strtod(text, NULL);
        }
        printf("%.17g,%u", time, (unsigned)bte_step(&state, &sample));
        for (int k = 0; k < BTE_ROW - 1; k++) {
            printf(",%.9g", (double)answers[k]);
        }
        printf("\n");
        last = time;
    }
    return fclose(file) != 0;
}

int main(int count, char *words[]) { return count > 1 ? run_file(words[1]) : compare(); }
#endif
