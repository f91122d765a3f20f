/* CAN channels by the raw mode of socketcand's protocol, as the hub at 127.0.0.1 speaks it. */
#include "channel.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static int say(channel_t *it, const char *text)
{
    size_t length = strlen(text);
    return send(it->socket, text, length, MSG_NOSIGNAL) == (ssize_t)length;
}

/* Wait for an answer, up to its bracket. */
static int is_answered(channel_t *it, const char *expected)
{
    char answer[32] = "";
    for (unsigned i = 0; i + 1 < sizeof answer; i++) {
        if (read(it->socket, &answer[i], 1) != 1) return 0;
        if (answer[i] == '>') return !strcmp(answer, expected);
    }
    return 0;
}

int channel_open(channel_t *it, const char *port, const char *name)
{
    struct sockaddr_in hub = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(port))};
    hub.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    char open[40];
    snprintf(open, sizeof open, "< open %s >", name);
    it->count = 0;
    it->socket = socket(AF_INET, SOCK_STREAM, 0);
    if (it->socket < 0 || connect(it->socket, (struct sockaddr *)&hub, sizeof hub)) return 0;
    setsockopt(it->socket, IPPROTO_TCP, TCP_NODELAY, &(int){1}, sizeof(int));
    return is_answered(it, "< hi >") && say(it, open) && is_answered(it, "< ok >") && say(it, "< rawmode >") &&
           is_answered(it, "< ok >");
}

int channel_send(channel_t *it, const can_frame_t *frame)
{
    char text[64];
    int length = snprintf(text, sizeof text, "< send %03X %u", (unsigned)frame->identifier, (unsigned)frame->length);
    for (unsigned i = 0; i < frame->length; i++) length += snprintf(text + length, sizeof text - length, " %02X", frame->data[i]);
    snprintf(text + length, sizeof text - length, " >");
    return say(it, text);
}

/* Of "< frame ID SECONDS DATA >"; anything else is no frame. */
static int parsed(const char *text, can_frame_t *frame)
{
    char data[17] = "";
    unsigned identifier, byte;
    if (sscanf(text, "< frame %x %*s %16[0-9A-F] >", &identifier, data) < 1) return 0;
    frame->identifier = identifier;
    frame->length = (uint8_t)(strlen(data) / 2);
    for (unsigned i = 0; i < frame->length; i++) {
        sscanf(data + 2 * i, "%2x", &byte);
        frame->data[i] = (uint8_t)byte;
    }
    return 1;
}

int channel_receive(channel_t *it, can_frame_t *frame)
{
    for (;;) {
        char *end = memchr(it->text, '>', it->count);
        if (end) {
            char text[80] = "";
            unsigned length = (unsigned)(end - it->text) + 1;
            memcpy(text, it->text, length < sizeof text ? length : sizeof text - 1);
            memmove(it->text, end + 1, it->count -= length);
            if (parsed(text, frame)) return 1;
            continue;
        }
        if (it->count == sizeof it->text) it->count = 0; /* no bracket in all this: it is no hub */
        ssize_t more = recv(it->socket, it->text + it->count, sizeof it->text - it->count, MSG_DONTWAIT);
        if (more <= 0) return 0;
        it->count += (unsigned)more;
    }
}
