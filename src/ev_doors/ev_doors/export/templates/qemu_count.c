/* Counts the instructions of a program that qemu-user emulates (qemu -plugin), in a memory that the program can read.
 *
 * The program finds it behind the descriptor DESCRIPTOR: it and its emulator are one process, so no two programs share
 * a count, and nothing is left when they end. Debian brings no header of QEMU's plugins: these are the few declarations
 * that are used, of which versions 1 to 6 of the interface have changed no more than its number, API.
 */
#define _GNU_SOURCE
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#define EXPORTED __attribute__((visibility("default")))

struct qemu_plugin_tb; /* some instructions that are executed one after the other */
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
void qemu_plugin_register_vcpu_tb_trans_cb(uint64_t id, void (*call)(uint64_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *block, void (*call)(unsigned, void *), int, void *given);

EXPORTED int qemu_plugin_version = API;

static uint64_t *instructions; /* of all blocks that have begun */

static void executed(unsigned processor, void *count) { *instructions += (uintptr_t)count; }

static void translated(uint64_t id, struct qemu_plugin_tb *block)
{
    qemu_plugin_register_vcpu_tb_exec_cb(block, executed, 0, (void *)qemu_plugin_tb_n_insns(block));
}

EXPORTED int qemu_plugin_install(uint64_t id, const void *of_emulator, int count, char **words)
{
    int file = memfd_create("instructions", 0);
    if (ftruncate(file, sizeof *instructions) || dup2(file, DESCRIPTOR) < 0) return -1;
    instructions = mmap(0, sizeof *instructions, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (instructions == MAP_FAILED) return -1;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    return 0;
}
