/* Cycles of docs/examples/ecu/ecu.c without a bus, with enabled drives that stand: ecu_cycles PEDAL ...
 *
 * For each PEDAL a line of "cycle", whether all is well, and the torques that went out, left and right [N m].
 */
#define main ecu
#include "ecu.c"
#undef main

static double sent[DRIVES];

int channel_open(channel_t *, const char *, const char *) { return 1; }
int channel_receive(channel_t *, can_frame_t *) { return 0; }

int channel_send(channel_t *, const can_frame_t *frame)
{
    int16_t raw = (int16_t)(frame->data[3] | frame->data[4] << 8); /* by the database: 24|16@1- (0.03125,0) */
    sent[frame->identifier == wired[RIGHT].set_point] = 0.03125 * raw;
    return 1;
}

int main(int count, char **words)
{
    drive_t drives[DRIVES] = {{.statusword = 0x27}, {.statusword = 0x27}};
    begin_law();
    for (int n = 1; n < count; n++) {
        int all_enabled = 1, is_well = cycle(drives, atof(words[n]), 1000, INT_MAX, &all_enabled);
        printf("cycle %d %g %g\n", is_well, sent[LEFT], sent[RIGHT]);
    }
    return 0;
}
