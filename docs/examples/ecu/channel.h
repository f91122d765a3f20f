/* A CAN channel as the ECU uses it. channel.c is one of the hub (ros2 run ev_bench can_hub); a board has its own. */
#ifndef CHANNEL_H
#define CHANNEL_H

#include <stdint.h>

typedef struct {
    uint32_t identifier;
    uint8_t data[8];
    uint8_t length;
} can_frame_t;

typedef struct {
    int socket;
    unsigned count; /* characters that wait */
    char text[4096];
} channel_t;

/* These return 1 where all is well, receive also 0 where nothing has come. None of them waits but open. */
int channel_open(channel_t *it, const char *port, const char *name);
int channel_send(channel_t *it, const can_frame_t *frame);
int channel_receive(channel_t *it, can_frame_t *frame);

#endif
