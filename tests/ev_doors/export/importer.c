/* An importer of FMUs of FMI 2 and 3 in C, for processors and systems where no other one is at hand.
 *
 *     importer LIBRARY VERSION TOKEN FIRST COUNT STEPS SIZE
 *
 * steps two instances in turn, and after half of the steps a third one from the state of the first as bytes. The numbers
 * of COUNT value references from FIRST on go to standard output after each step, as float64; instances that differ, and
 * a status that is not 0, end it.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
#define OPEN(path) (void *)LoadLibraryA(path)
#define FIND(library, name) (void *)GetProcAddress((HMODULE)(library), name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#endif

static void *library;
static int version;

static void *function(const char *name)
{
    char full[60];
    snprintf(full, sizeof full, "fmi%d%s", version, name);
    void *found = FIND(library, full);
    if (!found) exit((fprintf(stderr, "%s is missing\n", full), 2));
    return found;
}

#define CALL(name, types, ...)                                                                                         \
    do {                                                                                                               \
        int status = ((int (*) types)function(name))(__VA_ARGS__);                                                     \
        if (status) exit((fprintf(stderr, "%s: status %d\n", name, status), 3));                                       \
    } while (0)

static void *made(const char *token)
{
    void *it;
    if (version == 2) {
        void *callbacks[5] = {0};
        it = ((void *(*)(const char *, int, const char *, const char *, void *, int, int))function("Instantiate"))(
            "one", 1, token, "", callbacks, 0, 0);
    } else {
        it = ((void *(*)(const char *, const char *, const char *, bool, bool, bool, bool, void *, size_t, void *, void *,
                         void *))function("InstantiateCoSimulation"))("one", token, "", 0, 0, 0, 0, 0, 0, 0, 0, 0);
    }
    if (!it) exit((fprintf(stderr, "no instance\n"), 4));
    if (version == 2) {
        CALL("SetupExperiment", (void *, int, double, double, int, double), it, 0, 0.0, 0.0, 0, 0.0);
        CALL("EnterInitializationMode", (void *), it);
    } else {
        CALL("EnterInitializationMode", (void *, bool, double, double, bool, double), it, 0, 0.0, 0.0, 0, 0.0);
    }
    CALL("ExitInitializationMode", (void *), it);
    return it;
}

static void *copy_of(void *from, const char *token)
{
    void *to = made(token), *state = 0, *again = 0;
    size_t size;
    CALL(version == 2 ? "GetFMUstate" : "GetFMUState", (void *, void **), from, &state);
    CALL(version == 2 ? "SerializedFMUstateSize" : "SerializedFMUStateSize", (void *, void *, size_t *), from, state, &size);
    uint8_t *bytes = malloc(size);
    CALL(version == 2 ? "SerializeFMUstate" : "SerializeFMUState", (void *, void *, uint8_t *, size_t), from, state, bytes, size);
    CALL(version == 2 ? "DeSerializeFMUstate" : "DeserializeFMUState", (void *, uint8_t *, size_t, void **), to, bytes, size, &again);
    CALL(version == 2 ? "SetFMUstate" : "SetFMUState", (void *, void *), to, again);
    CALL(version == 2 ? "FreeFMUstate" : "FreeFMUState", (void *, void **), from, &state);
    CALL(version == 2 ? "FreeFMUstate" : "FreeFMUState", (void *, void **), to, &again);
    free(bytes);
    return to;
}

int main(int count_of_words, char **words)
{
    if (count_of_words != 8) return 1;
    version = atoi(words[2]);
    if (!(library = OPEN(words[1]))) return fprintf(stderr, "%s cannot be loaded\n", words[1]), 1;
#ifdef _WIN32
    _setmode(_fileno(stdout), _O_BINARY);
#endif
    const char *token = words[3];
    size_t first = (size_t)atoi(words[4]), count = (size_t)atoi(words[5]);
    int steps = atoi(words[6]);
    double size = atof(words[7]), *values[3], last;
    uint32_t *references = malloc(count * sizeof *references);
    for (size_t i = 0; i < count; i++) references[i] = (uint32_t)(first + i);
    for (int k = 0; k < 3; k++) values[k] = malloc(count * sizeof(double));
    void *instances[3] = {made(token), made(token), 0};
    for (int n = 0; n < steps; n++) {
        if (n == steps / 2) instances[2] = copy_of(instances[0], token);
        for (int k = 0; k < 3 && instances[k]; k++) {
            bool flags[3];
            if (version == 2) {
                CALL("DoStep", (void *, double, double, int), instances[k], n * size, size, 1);
                CALL("GetReal", (void *, uint32_t *, size_t, double *), instances[k], references, count, values[k]);
            } else {
                CALL("DoStep", (void *, double, double, bool, bool *, bool *, bool *, double *), instances[k], n * size, size, 1,
                     &flags[0], &flags[1], &flags[2], &last);
                CALL("GetFloat64", (void *, uint32_t *, size_t, double *, size_t), instances[k], references, count, values[k],
                     count);
            }
            if (memcmp(values[k], values[0], count * sizeof(double))) return fprintf(stderr, "instance %d differs\n", k), 5;
        }
        fwrite(values[0], sizeof(double), count, stdout);
    }
    for (int k = 0; k < 3; k++)
        if (instances[k]) ((void (*)(void *))function("FreeInstance"))(instances[k]);
    return 0;
}
