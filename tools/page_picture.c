/*
 * Pictures by a browser; see page_picture.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700

#include "page_picture.h"

#include "model_file.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PATH_SIZE = 1024, SECONDS = 60 };

static const char *const browsers[] = {"chromium", "chromium-browser", "google-chrome",
                                       "google-chrome-stable"};

bool page_picture_begin(char *path, size_t size, char error[MESH_FILE_ERROR_SIZE])
{
    const char *folder = getenv("TMPDIR");
    const int length = snprintf(path, size, "%s/sc-query-XXXXXX", folder ? folder : "/tmp");
    if (length < 0 || (size_t)length + sizeof "/page.html" > size || !mkdtemp(path)) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "no folder can be made in %s: %s",
                 folder ? folder : "/tmp", strerror(errno));
        return false;
    }
    strcat(path, "/page.html");
    return true;
}

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *place)
{
    (void)about;
    (void)kind;
    (void)place;
    return remove(path);
}

/* The folder of a page. */
static void folder_of(const char *path, char folder[PATH_SIZE])
{
    snprintf(folder, PATH_SIZE, "%.*s", (int)(strlen(path) - strlen("/page.html")), path);
}

void page_picture_end(const char *path)
{
    char folder[PATH_SIZE];
    folder_of(path, folder);
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

/* In the child: becomes the browser. Does not return. */
static void run_browser(const char *folder)
{
    char profile[PATH_SIZE + 32], shot[PATH_SIZE + 32], page[PATH_SIZE + 32];
    snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", folder);
    snprintf(shot, sizeof shot, "--screenshot=%s/page.png", folder);
    snprintf(page, sizeof page, "file://%s/page.html#picture", folder);
    static char fixed[][40] = {"browser",
                               "--headless",
                               "--window-size=1500,500",
                               "--hide-scrollbars",
                               "--force-device-scale-factor=1",
                               "--no-first-run",
                               "--disable-extensions",
                               "--enable-unsafe-swiftshader",
                               "--virtual-time-budget=20000",
                               "--no-sandbox"};
    enum { FIXED = sizeof fixed / sizeof fixed[0] };
    char *arguments[FIXED + 4];
    size_t count = 0;
    /* as root, Chromium runs only without its sandbox; the page is our own and asks for nothing */
    for (size_t i = 0; i < FIXED - (geteuid() == 0 ? 0u : 1u); i++) arguments[count++] = fixed[i];
    arguments[count++] = profile;
    arguments[count++] = shot;
    arguments[count++] = page;
    arguments[count] = NULL;
    const int nowhere = open("/dev/null", O_RDWR);
    for (int i = 0; i < 3 && nowhere >= 0; i++) dup2(nowhere, i);
    setpgid(0, 0); /* so that it can be ended with all its processes */
    const char *given = getenv("SC_BROWSER");
    if (given && given[0]) {
        execvp(given, arguments);
        _exit(127);
    }
    for (size_t i = 0; i < sizeof browsers / sizeof browsers[0]; i++)
        execvp(browsers[i], arguments);
    _exit(127);
}

/* Waits until the browser ends, or ends it; its status, or -1. */
static int wait_for(pid_t browser)
{
    const struct timespec tenth = {0, 100000000};
    for (int i = 0; i < 10 * SECONDS; i++) {
        int status;
        const pid_t ended = waitpid(browser, &status, WNOHANG);
        if (ended == browser) return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        if (ended < 0) return -1;
        nanosleep(&tenth, NULL);
    }
    kill(-browser, SIGKILL);
    waitpid(browser, NULL, 0);
    return -1;
}

bool page_picture_draw(const char *path, const char *png_path, char error[MESH_FILE_ERROR_SIZE])
{
    char folder[PATH_SIZE], shot[PATH_SIZE + 32];
    folder_of(path, folder);
    snprintf(shot, sizeof shot, "%s/page.png", folder);
    const pid_t browser = fork();
    if (browser == 0) run_browser(folder);
    const int status = browser < 0 ? -1 : wait_for(browser);
    if (status == 127) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: no browser to draw it: install Chromium, or name one in SC_BROWSER",
                 png_path);
        return false;
    }
    uint64_t size;
    void *bytes = model_file_bytes(shot, &size, error);
    if (!bytes || size < 8 || memcmp(bytes, "\x89PNG", 4) != 0) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: the browser drew no picture", png_path);
        free(bytes);
        return false;
    }
    const bool written = model_file_dump(png_path, bytes, size, error);
    free(bytes);
    return written;
}
