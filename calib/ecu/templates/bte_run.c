/* Run the estimator of brake-cal over many samples, for tests: the function bte_run.
 *
 * With BTE_VECTORS defined this file is a program for a PC. Without an argument it compares its
 * answers with those of Python in bte_vectors.h. With the file of a stop, as `brake-cal log --si`
 * writes it, it prints its answers to the stop:
 *
 *     bte_run stop.csv > answers.csv
 */
#include <string.h>

#include "bte.h"

enum { BTE_ROW = 1 + (int)(sizeof(bte_answers) / sizeof(bte_real)) }; /* the reason, the answers */

void bte_run(const bte_car *car, const bte_real *samples, uint32_t count, bte_real *rows);

/* Run `count` rows of inputs from the start into rows of answers. */
void bte_run(const bte_car *car, const bte_real *samples, uint32_t count, bte_real *rows) {
    static bte_state state;
    (void)bte_init(&state, car);
    for (uint32_t i = 0; i < count; i++) {
        bte_inputs x;
        (void)memcpy(&x, &samples[i * BTE_INPUTS], sizeof x);
        rows[i * BTE_ROW] = (bte_real)bte_step(&state, &x);
        (void)memcpy(&rows[i * BTE_ROW + 1U], &state.answers, sizeof state.answers);
    }
}

#ifdef BTE_VECTORS
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bte_vectors.h"

enum { LINE = 65536, CELLS = 1024, REFUSED = 2 };

/* Compare the answers at the ends of the blocks with those of Python; 1 if they differ. */
static int compare(void) {
    static bte_real rows[BTE_VECTORS_COUNT * BTE_ROW];
    unsigned wrong = 0U;
    double worst = 0.0;
    bte_run(BTE_VECTORS_CAR, &bte_vectors_inputs[0][0], BTE_VECTORS_COUNT, rows);
    for (uint32_t i = 0; i < BTE_VECTORS_COUNT / BTE_VECTORS_EVERY * BTE_ROW; i++) {
        const uint32_t end = (i / BTE_ROW + 1U) * BTE_VECTORS_EVERY - 1U;
        const double right = (double)bte_vectors_answers[i / BTE_ROW][i % BTE_ROW];
        const double answer = (double)rows[end * BTE_ROW + i % BTE_ROW];
        const double apart = fabs(answer - right) / fmax(right, 1e-6); /* of reasons 0.1 or more */
        wrong += !(apart <= BTE_VECTORS_TOLERANCE);
        worst = fmax(worst, apart);
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

/* Return the place of a column; -1 if there is none, -2 if it has another unit. */
static int place_of(char *const cell[], int count, const char *column) {
    const size_t name = strcspn(column, " ");
    for (int k = 0; k < count; k++) {
        if (strncmp(cell[k], column, name) == 0 && strchr(" [", cell[k][name]) != NULL) {
            return strcmp(cell[k], column) == 0 ? k : -2;
        }
    }
    return -1;
}

static void print_row(const bte_state *s, double time) {
    bte_real y[BTE_ROW - 1];
    (void)memcpy(y, &s->answers, sizeof y);
    printf("%.17g,%u", time, (unsigned)s->reason);
    for (int k = 0; k < BTE_ROW - 1; k++) {
        printf(",%.9g", (double)y[k]);
    }
    printf("\n");
}

/* Print the answers to the samples of a file. In a gap of the file all sensors fail. */
static int run_file(const char *path) {
    static char line[LINE];
    static bte_state state;
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
        place[i] = place_of(cell, columns, bte_vectors_columns[i]);
        if (place[i] == -2 || (place[i] < 0 && i < BTE_VECTORS_NEEDED)) {
            return refuse(path, "no column ", bte_vectors_columns[i]);
        }
    }
    printf("%s\n", bte_vectors_header);
    (void)bte_init(&state, BTE_VECTORS_CAR);
    for (unsigned rows = 0; fgets(line, LINE, file) != NULL; rows++) {
        bte_inputs x;
        bte_real row[BTE_INPUTS];
        const int count = split(line, cell);
        const double time = time_place < count ? strtod(cell[time_place], NULL) : -1.0;
        const double steps = rows == 0U ? 1.0 : (time - last) / step;
        /* the first step tells the rate, a later one may be a gap */
        if (!(steps > 0.75 && (rows > 1U || steps < 1.25))) {
            return refuse(path, "its rate is not the `sample_time` of the code", "");
        }
        for (int i = 0; i < BTE_INPUTS; i++) {
            row[i] = (bte_real)NAN;
        }
        (void)memcpy(&x, row, sizeof x);
        for (double k = 1.0; k < fmin(floor(steps + 0.5), 10.0 / step); k += 1.0) {
            (void)bte_step(&state, &x);
        }
        for (int i = 0; i < BTE_INPUTS; i++) {
            const char *text = place[i] >= 0 && place[i] < count ? cell[place[i]] : "0";
            row[i] = *text == '\0' ? (bte_real)NAN : (bte_real)strtod(text, NULL);
        }
        (void)memcpy(&x, row, sizeof x);
        (void)bte_step(&state, &x);
        print_row(&state, time);
        last = time;
    }
    return fclose(file) != 0;
}

int main(int count, char *words[]) { return count > 1 ? run_file(words[1]) : compare(); }
#endif
