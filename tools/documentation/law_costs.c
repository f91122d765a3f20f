/* What a step of an exported law costs: law_costs ROWS WHAT, with ROWS rows of inputs at standard input.
 *
 * WHAT is `nothing`: the inputs are set; `steps`: and the law answers; `stack`: and the bytes of stack that the answers
 * have needed follow. The outputs after each row go to standard output.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "evs_model.h"

enum { PAINTED = 1 << 18 };

/* As in the exported program. */
static __attribute__((noinline)) uint32_t stack(int is_painted)
{
    volatile uint8_t below[PAINTED];
    uint32_t free = 0;
    if (is_painted)
        for (uint32_t i = 0; i < PAINTED; i++) below[i] = 0xa5;
    while (free < PAINTED && below[free] == 0xa5) free++;
    return PAINTED - free;
}

int main(int count, char **words)
{
    if (count != 3) return 1;
    static evs_model it;
    size_t rows = (size_t)atol(words[1]), width = EVS_MODEL_INPUTS;
    int answers = strcmp(words[2], "nothing"), is_measured = !strcmp(words[2], "stack");
    double *inputs = malloc(rows * width * sizeof(double)), *outputs = malloc(rows * EVS_MODEL_OUTPUTS * sizeof(double));
    if (!inputs || !outputs || fread(inputs, width * sizeof(double), rows, stdin) != rows || evs_model_create(&it)) return 2;
    if (is_measured) stack(1);
    for (size_t n = 0; n < rows; n++) {
        for (size_t i = 0; i < width; i++) evs_model_set_input(&it, (int32_t)i, inputs[n * width + i]);
        if (answers && evs_model_step(&it)) return 3;
        for (size_t i = 0; i < EVS_MODEL_OUTPUTS; i++) outputs[n * EVS_MODEL_OUTPUTS + i] = evs_model_output(&it, (int32_t)i);
    }
    uint32_t used = is_measured ? stack(0) : 0;
    fwrite(outputs, EVS_MODEL_OUTPUTS * sizeof(double), rows, stdout);
    fwrite(&used, sizeof used, 1, stdout);
    return 0;
}
