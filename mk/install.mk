# make install: program, library, headers, pkg-config file, udev rule, man pages. PREFIX and DESTDIR as usual.
PUBLIC_HEADERS := $(wildcard driver/include/hitpipe/*.h) \
                  $(addprefix rtl_model/include/hitpipe/,types.h config.h counters.h packet.h pipe.h usb.h) \
                  $(wildcard rtl_model/include/hitpipe/*.def)
MAN_PAGES := $(wildcard docs/man/*.[1-9])
DEST := $(DESTDIR)$(PREFIX)

install: all ## put program, library, headers, pkg-config file, udev rule and man pages under PREFIX
	install -d $(DEST)/bin $(DEST)/lib/pkgconfig $(DEST)/include/hitpipe
	install -m 755 $(HITPIPE) $(DEST)/bin/hitpipe
	install -m 644 $(LIB) $(DEST)/lib/libhitpipe.a
	install -m 755 $(SHLIB) $(DEST)/lib/libhitpipe.so.$(VERSION)
	ln -sf libhitpipe.so.$(VERSION) $(DEST)/lib/libhitpipe.so.0
	ln -sf libhitpipe.so.0 $(DEST)/lib/libhitpipe.so
	install -m 644 $(PUBLIC_HEADERS) $(DEST)/include/hitpipe
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@LIBS@|$(LIBS_LIB)|' mk/hitpipe.pc.in >$(DEST)/lib/pkgconfig/hitpipe.pc
	install -D -m 644 mk/60-hitpipe.rules $(DEST)/lib/udev/rules.d/60-hitpipe.rules
	@for page in $(MAN_PAGES); do \
	    install -D -m 644 $$page $(DEST)/share/man/man$${page##*.}/$${page##*/} || exit 1; done
	@if [ -z "$(DESTDIR)" ] && [ "$$(id -u)" = 0 ]; then ldconfig || true; udevadm control --reload 2>/dev/null || true; fi

uninstall: ## take away what `make install` put there
	rm -f $(DEST)/bin/hitpipe $(DEST)/lib/libhitpipe.* $(DEST)/lib/pkgconfig/hitpipe.pc
	rm -f $(DEST)/lib/udev/rules.d/60-hitpipe.rules
	rm -rf $(DEST)/include/hitpipe
	@for page in $(MAN_PAGES); do rm -f $(DEST)/share/man/man$${page##*.}/$${page##*/}; done

.PHONY: uninstall
